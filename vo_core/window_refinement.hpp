#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {

/// Features in one of so many parts of the image are taken to err together.
constexpr int kCovarianceColumns = 16, kCovarianceRows = 8;
constexpr int kCovarianceCells = kCovarianceColumns * kCovarianceRows;

/// One earlier sighting of a feature, carried into the world by the pose of the frame that had it.
struct EarlierPoint {
  Eigen::Vector3d world = Eigen::Vector3d::Zero();       ///< m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m^2, world axes
};

/// A feature seen now and by some of the last frames.
struct RefinementFeature {
  Eigen::Vector3d current = Eigen::Vector3d::Zero();             ///< m, in the current camera's axes
  Eigen::Matrix3d current_covariance = Eigen::Matrix3d::Zero();  ///< m^2
  double weight = 1.0;                                           ///< from feature history
  int cell = 0;                       ///< part of the image it lies in; >= 0, below kCovarianceCells
  std::vector<EarlierPoint> earlier;  ///< not empty, newest first
};

struct RefinedPose {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  /// Of the pose against the earlier frames, as a perturbation on the right; from the spread of the weighted
  /// errors, cell by cell (the sandwich estimator: P. Huber, "Robust Statistics", over clusters: K. Liang,
  /// S. Zeger, "Longitudinal data analysis using generalized linear models", 1986), so that it holds whatever
  /// the weights are and however the errors of a feature and of its neighbours hang together.
  Matrix6d covariance = Matrix6d::Zero();
  double scale = 1.0;      ///< how much larger the errors are than the assumed noise; at least 1
  bool converged = false;  ///< false: the features leave the pose open; it is returned as it came
};

/// Lays the current point cloud on those of the last frames (thesis 5.1): minimises over the current pose T
/// sum h w |T^-1 X - P|^2 over features and earlier frames, X being a point of an earlier frame in the world,
/// h the history weight and w that of (4.16). Distances count in standard deviations of the two points, so
/// that far features tell of the rotation though their depth is vague: 4.15 alone cannot. The poses of
/// earlier frames stand: what has been published does not change. `scale`: see EstimatedMotion.
RefinedPose refinePose(const Eigen::Isometry3d& T_world_camera,
                       const std::vector<RefinementFeature>& features, double scale, double radius,
                       const RefinementSettings& settings);

}  // namespace cartvo
