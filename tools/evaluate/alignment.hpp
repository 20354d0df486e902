#pragma once

#include "tools/evaluate/association.hpp"

namespace cartvo {

/// RMSE of position after the rigid alignment that minimises it (S. Umeyama, 1991, without scale), m.
double alignedError(const AssociatedTrajectories& associated);

/// Fits the estimate to the truth as `settings` asks: by rotation and translation of its world and a constant
/// rotation of its axes (aligns), by the scale of its path (corrects_scale), or by both. Throws
/// std::runtime_error at a standstill, which determines none of them.
void fitEstimate(const ComparisonSettings& settings, AssociatedTrajectories& associated);

/// The estimate in the truth's world: as it was fitted, else such that the first poses coincide.
Trajectory placedEstimate(const AssociatedTrajectories& associated);

/// How placedEstimate() places it: "aligned" or "starts coincide".
const char* placementName(const AssociatedTrajectories& associated);

}  // namespace cartvo
