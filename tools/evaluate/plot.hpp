#pragma once

#include "tools/evaluate/association.hpp"
#include "tools/evaluate/ground_paths.hpp"
#include "tools/report/drawing.hpp"

namespace cartvo {

/// Plots both paths from above with coinciding starts, and the position error over the distance driven.
Drawing plotTrajectories(const AssociatedTrajectories& associated, TopView view);

}  // namespace cartvo
