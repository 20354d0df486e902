#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "vo_core/odometry_settings.hpp"

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

 private:
  struct Stay {
    Eigen::Isometry3d T_world_camera;
    std::int64_t time_ns;
  };
  StandstillSettings settings_;
  std::optional<Stay> since_;
};

}  // namespace cartvo
