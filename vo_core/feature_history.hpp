#pragma once

#include <Eigen/Core>

#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// One step of a feature through the world, from one pair to the next: where it went though it should have
/// stood still.
struct WorldStep {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();    ///< m^2, of the displacement
};

/// Variance of a feature's motion from t-2 to t-1 to t about rest, in units of its expected variance: 1 for a
/// point of the static world, more for one that moves.
double motionVariance(const WorldStep& earlier, const WorldStep& later);

/// The weight a feature goes on with: half of what it had, and half of 1 / (1 + variance / deviation^2). A
/// feature on a moving object loses its weight within a few pairs; one that fell out of line by chance wins
/// it back.
double historyWeight(double weight, double motion_variance, const HistorySettings& settings);

}  // namespace cartvo
