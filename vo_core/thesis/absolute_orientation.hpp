#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace cartvo::vo {

/// A point in two coordinate frames and its weight, >= 0.
struct PointPair {
  Eigen::Vector3d from;
  Eigen::Vector3d to;
  double weight = 1.0;
};

/// The motion T that minimises sum w |to - T from|^2 (thesis 4.15; B. Horn, "Closed-form solution of absolute
/// orientation using unit quaternions", 1987): the rotation is the eigenvector of the greatest eigenvalue of
/// Horn's 4x4 matrix, the translation the remaining difference of the centroids. No scale. Nothing if fewer
/// than three pairs have a positive weight or the points lie on one line, which leaves the rotation about it
/// undetermined.
std::optional<Eigen::Isometry3d> absoluteOrientation(const std::vector<PointPair>& pairs);

}  // namespace cartvo::vo
