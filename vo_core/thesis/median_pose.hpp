#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace cartvo::vo {

/// Component-wise median of `poses`, which must not be empty: of the translations, and of the rotation
/// vectors relative to the first pose's rotation (from which they must be within pi). The upper median of an
/// even number.
Eigen::Isometry3d medianPose(const std::vector<Eigen::Isometry3d>& poses);

}  // namespace cartvo::vo
