#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {

/// Tells a cart that stands from one that moves: its pose has stayed within a few millimetres for some time.
class StandstillDetector {
 public:
  explicit StandstillDetector(const StandstillSettings& settings) : settings_(settings) {}

  /// Takes the next pose; whether the cart stands.
  bool stands(const Eigen::Isometry3d& T_world_camera, std::int64_t time_ns) {
    if (!since_ || beyond(since_->T_world_camera.inverse() * T_world_camera))
      since_ = Stay{T_world_camera, time_ns};
    return 1e-9 * static_cast<double>(time_ns - since_->time_ns) >= settings_.least_time;
  }

  /// Whether a motion is more than the standing of a cart explains.
  bool beyond(const Eigen::Isometry3d& motion) const {
    return motion.translation().norm() > settings_.translation ||
           Eigen::AngleAxisd(motion.linear()).angle() > settings_.rotation;
  }

  /// Covariance of where a cart that is taken to stand is in truth: anywhere within the limits, evenly.
  Matrix6d stray() const {
    Vector6d square;
    square << Eigen::Vector3d::Constant(settings_.translation * settings_.translation / 3.0),
        Eigen::Vector3d::Constant(settings_.rotation * settings_.rotation / 3.0);
    return square.asDiagonal();
  }

 private:
  struct Stay {
    Eigen::Isometry3d T_world_camera;
    std::int64_t time_ns;
  };
  StandstillSettings settings_;
  std::optional<Stay> since_;
};

}  // namespace cartvo
