#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "vo_core/fixed_constants.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {

/// Detects a standstill: the pose has stayed within a few millimetres for a minimum time.
class StandstillDetector {
 public:
  explicit StandstillDetector(const StandstillSettings& settings) : settings_(settings) {}

  /// Processes the next pose and its time (ns); returns whether the cart is at a standstill.
  bool update(const Eigen::Isometry3d& T_world_camera, std::int64_t time_ns) {
    if (!start_ || exceedsLimits(start_->T_world_camera.inverse() * T_world_camera))
      start_ = Start{T_world_camera, time_ns};
    return 1e-9 * static_cast<double>(time_ns - start_->time_ns) >= settings_.least_time;
  }

  /// Whether a motion exceeds the translation or rotation that a standstill permits.
  bool exceedsLimits(const Eigen::Isometry3d& motion) const { return exceedsLimits(motion, 1.0); }
  /// The same of `factor` times these limits.
  bool exceedsLimits(const Eigen::Isometry3d& motion, double factor) const {
    return motion.translation().norm() > factor * settings_.translation ||
           Eigen::AngleAxisd(motion.linear()).angle() > factor * settings_.rotation;
  }

  /// Whether a measured motion exceeds the limits by more than its errors.
  bool isExceededBy(const Eigen::Isometry3d& motion, const Matrix6d& covariance) const {
    if (!exceedsLimits(motion)) return false;
    const Vector6d vector = vectorFromMotion(motion);
    const double square = vector.dot(covariance.ldlt().solve(vector));
    return square > settings_.motion_significance * settings_.motion_significance;
  }

  /// Covariance of a motion during a standstill, whose bounds are the limits.
  Matrix6d motionCovariance() const {
    return 3.0 / (protection::kBoundFactor * protection::kBoundFactor) * covariance();
  }

  /// Covariance of the true pose at a standstill: uniform within the limits.
  Matrix6d covariance() const {
    Vector6d square;
    square << Eigen::Vector3d::Constant(settings_.translation * settings_.translation / 3.0),
        Eigen::Vector3d::Constant(settings_.rotation * settings_.rotation / 3.0);
    return square.asDiagonal();
  }

 private:
  struct Start {
    Eigen::Isometry3d T_world_camera;
    std::int64_t time_ns;
  };
  StandstillSettings settings_;
  std::optional<Start> start_;
};

}  // namespace cartvo::vo
