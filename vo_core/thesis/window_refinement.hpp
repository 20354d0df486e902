#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"

// Refinement of the current pose against the point clouds of the last frames (thesis 5.1).

namespace cartvo::vo {

/// Grid of cells of the image; the errors of features in one cell are correlated.
constexpr int kCovarianceColumns = 16, kCovarianceRows = 8;
constexpr int kCovarianceCells = kCovarianceColumns * kCovarianceRows;

/// An earlier observation of a feature, carried to the world by the pose of its frame.
struct EarlierPoint {
  Eigen::Vector3d world = Eigen::Vector3d::Zero();       ///< m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m^2, world axes
};

/// A feature that the current and some of the last frames observed.
struct RefinementFeature {
  Eigen::Vector3d current = Eigen::Vector3d::Zero();             ///< m, in the current camera's axes
  Eigen::Matrix3d current_covariance = Eigen::Matrix3d::Zero();  ///< m^2
  double weight = 1.0;                                           ///< from feature history
  int cell = 0;                       ///< cell of the image, in [0, kCovarianceCells)
  std::vector<EarlierPoint> earlier;  ///< not empty, newest first
};

/// Result of refinePose().
struct RefinedPose {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  /// Covariance of the pose relative to the earlier frames, as a perturbation on the right. It comes from the
  /// spread of the weighted errors, cell by cell (the sandwich estimator: P. Huber, "Robust Statistics", over
  /// clusters: K. Liang, S. Zeger, "Longitudinal data analysis using generalized linear models", 1986), so
  /// that it holds whatever the weights are and however the errors of a feature and of its neighbours
  /// correlate.
  Matrix6d covariance = Matrix6d::Zero();
  double scale = 1.0;      ///< ratio of the errors to the assumed noise; at least 1
  bool converged = false;  ///< false: the features do not determine the pose, which is returned unchanged
};

/// Aligns the current point cloud with those of the last frames (thesis 5.1): minimises over the current pose
/// T sum h w |T^-1 X - P|^2 over features and earlier frames, where X is a point of an earlier frame in the
/// world, h the history weight and w that of (4.16). Distances are in standard deviations of the two points,
/// so that far features constrain the rotation although their depth is imprecise, which 4.15 alone cannot do.
/// The poses of earlier frames are fixed: published poses do not change. `scale`: see EstimatedMotion.
RefinedPose refinePose(const Eigen::Isometry3d& T_world_camera,
                       const std::vector<RefinementFeature>& features, double scale, double radius,
                       const RefinementSettings& settings);

}  // namespace cartvo::vo
