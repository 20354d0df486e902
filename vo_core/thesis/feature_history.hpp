#pragma once

#include <Eigen/Core>

#include "vo_core/odometry_settings.hpp"

// Weight of a feature by its motion relative to the static world.

namespace cartvo::vo {

/// Displacement of a feature in the world from one pair to the next; a static point has none but noise.
struct WorldStep {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();    ///< m^2, of the displacement
};

/// Variance of a feature's motion from t-2 over t-1 to t about zero, in units of its expected variance: 1 for
/// a point of the static world, more for one that moves.
double motionVariance(const WorldStep& earlier, const WorldStep& later);

/// Updated weight: half of the old one plus half of 1 / (1 + variance / half_weight_stddevs^2). A feature on
/// a moving object loses its weight within a few pairs; a chance outlier regains it.
double historyWeight(double weight, double motion_variance, const HistorySettings& settings);

}  // namespace cartvo::vo
