#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace cartvo {

/// The median of some poses, component by component: of the translations, and of the rotation vectors seen
/// from the first pose's rotation (so they must lie within pi of it). Of an even number the upper median.
/// `poses` must not be empty.
Eigen::Isometry3d medianPose(const std::vector<Eigen::Isometry3d>& poses);

}  // namespace cartvo
