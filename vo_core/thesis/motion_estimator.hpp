#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "vo_core/geometry/subset_random.hpp"
#include "vo_core/odometry_settings.hpp"

// Robust motion from 3D-3D point matches (thesis 4.15, 4.16).

namespace cartvo::vo {

/// Point of a feature in the reference and in the current camera.
struct PointMatch {
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();             ///< m, in the reference camera's axes
  Eigen::Vector3d current = Eigen::Vector3d::Zero();               ///< m, in the current camera's axes
  Eigen::Matrix3d reference_covariance = Eigen::Matrix3d::Zero();  ///< m^2
  Eigen::Matrix3d current_covariance = Eigen::Matrix3d::Zero();    ///< m^2
  double weight = 1.0;                                             ///< from feature history
};

/// Result of estimateMotion().
struct EstimatedMotion {
  Eigen::Isometry3d T_reference_current = Eigen::Isometry3d::Identity();
  double scale = 1.0;        ///< ratio of the errors to the assumed noise; at least 1
  std::vector<bool> inlier;  ///< of each match: within the radius
  int inliers = 0;
};

/// Estimates the motion in three steps: Horn's absolute orientation (thesis 4.15) over random subsets, the
/// median pose of the subsets, then Horn over all features with weights w = 1/|c| that are recomputed from
/// each solution (thesis 4.16).
///
/// Beyond the thesis: c is in standard deviations of each point (prediction_error.hpp) and Horn's weights
/// include the inverse variance; the radius widens with the errors' median where images are noisier than
/// assumed; and the median is taken of the better quarter of the subsets' poses, by the sum of their
/// truncated errors, which tolerates more outliers than the few that the median of all poses does. Nothing if
/// there are fewer matches than a subset has, or if no subset has a pose.
std::optional<EstimatedMotion> estimateMotion(const std::vector<PointMatch>& matches,
                                              const MotionSettings& settings, SubsetRandom& random);

}  // namespace cartvo::vo
