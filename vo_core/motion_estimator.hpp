#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "vo_core/odometry_settings.hpp"
#include "vo_core/subset_random.hpp"

namespace cartvo {

/// A feature's point seen from the reference and from the current camera.
struct PointMatch {
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();             ///< m, in the reference camera's axes
  Eigen::Vector3d current = Eigen::Vector3d::Zero();               ///< m, in the current camera's axes
  Eigen::Matrix3d reference_covariance = Eigen::Matrix3d::Zero();  ///< m^2
  Eigen::Matrix3d current_covariance = Eigen::Matrix3d::Zero();    ///< m^2
  double weight = 1.0;                                             ///< from feature history
};

struct EstimatedMotion {
  Eigen::Isometry3d T_reference_current = Eigen::Isometry3d::Identity();
  double scale = 1.0;        ///< how much larger the errors are than the assumed noise; at least 1
  std::vector<bool> inlier;  ///< of each match: within the radius
  int inliers = 0;
};

/// Horn's absolute orientation (thesis 4.15) over random subsets, the median pose of the subsets, then Horn
/// over all features with weights w = 1/|c| that are found again from each solution (thesis 4.16).
///
/// Beyond the thesis: c counts in standard deviations of each point (prediction_error.hpp) and Horn's weights
/// carry the inverse variance too; the radius widens with the errors' median where images are noisier than
/// assumed; and the median is taken of the better quarter of the subsets' poses, by the sum of their
/// truncated errors, so that outliers may be more than the few that the median of all poses stands. Nothing
/// if there are less matches than a subset, or no subset has a pose.
std::optional<EstimatedMotion> estimateMotion(const std::vector<PointMatch>& matches,
                                              const MotionSettings& settings, SubsetRandom& random);

}  // namespace cartvo
