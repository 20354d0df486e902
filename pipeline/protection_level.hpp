#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>

#include "common/units.hpp"
#include "pipeline/body_motion.hpp"
#include "vo_core/fixed_constants.hpp"
#include "vo_core/odometry_settings.hpp"

// Bounds of the errors of a published motion, and the alert limits that they are compared with. The terms are
// those of satellite navigation (RTCA DO-229: protection level, alert limit).

namespace cartvo::pipeline {

using vo::protection::kBoundFactor, vo::protection::kUnannouncedJerk, vo::protection::kKerbRate;
/// Added for the motion of the last second.
using vo::protection::kMotionFloor, vo::protection::kRotationFloor, vo::protection::kWayShare;

/// Bounds that the errors of a pair's motion exceed with a probability of at most 1e-4 a message, in the axes
/// of the current body. NaN if there is no estimate.
struct ProtectionLevel {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector3d velocity = Eigen::Vector3d::Constant(kUnknown);      ///< m/s
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Constant(kUnknown);  ///< rad/s
  /// m and rad, translation and rotation over the last second: since the oldest pose of the last second and
  /// the epoch that was VALID; if there is none, since the previous pair.
  Eigen::Vector3d motion = Eigen::Vector3d::Constant(kUnknown);
  Eigen::Vector3d rotation = Eigen::Vector3d::Constant(kUnknown);
};

/// Largest bounds, for each axis, with which a motion is valid. config/cartvod.yaml explains the defaults.
struct AlertLimits {
  double velocity = 0.7;                           ///< m/s
  double angular_rate = 12.0 * kRadiansPerDegree;  ///< rad/s
  double motion = 0.2;                             ///< m, translation over the last second
  double rotation = 1.5 * kRadiansPerDegree;       ///< rad, rotation over the last second
};

/// Names of the four kinds of bounds.
enum class BoundedQuantity : std::uint8_t { velocity, angular_rate, motion, rotation };

/// A bound and the alert limit that belongs to it.
struct LimitedBound {
  BoundedQuantity quantity = BoundedQuantity::velocity;
  int axis = 0;  ///< 0 to 2: x, y, z of the body
  double bound = 0.0;
  double limit = 1.0;

  double share() const { return bound / limit; }
  bool isExceeded() const { return !(bound < limit); }
  /// 100 for a bound of zero, at least 1 below the limit, 0 from the limit on.
  int quality() const;
  /// For the operator, for example "forward velocity is known to 0.42 m/s, alert limit 0.30 m/s".
  std::string text() const;
};

/// The one of the twelve bounds that is largest relative to its limit.
LimitedBound worstBound(const ProtectionLevel& level, const AlertLimits& limits);

/// Computes the protection levels of consecutive estimates of the rectified left camera. Not thread-safe.
class ProtectionLevels {
 public:
  /// `T_body_rectified` and `scale_stddev`: see bodyMotion(). `uncertainty`: has the drift that neighbouring
  /// motions share.
  ProtectionLevels(const Eigen::Isometry3d& T_body_rectified, double scale_stddev,
                   const vo::UncertaintySettings& uncertainty);

  /// `motion`: of the body, with velocities at the exposure.
  ProtectionLevel update(const vo::OdometryEstimate& estimate, const BodyMotion& motion);

  /// The pair of the last update() is published as VALID: a reader may take differences from its pose.
  void setValid() { newest_valid_ = true; }

 private:
  struct Motion {
    bool starts_valid = false;  ///< the pose that the motion starts from was published as VALID
    bool stands = false;        ///< by a zero-velocity update
    double time_step = 0.0;
    Eigen::Isometry3d T_previous_current;
    vo::Matrix6d covariance;
  };

  struct LastSecond {
    vo::Matrix6d covariance;
    double distance = 0.0;  ///< m, from its first to its last pose
  };

  void add(const vo::OdometryEstimate& estimate);
  LastSecond lastSecond() const;

  Eigen::Isometry3d T_body_rectified_;
  double scale_stddev_;
  vo::UncertaintySettings uncertainty_;
  std::deque<Motion> motions_;  ///< of the last second, the newest last
  bool newest_valid_ = false;   ///< the newest pair with an estimate was published as VALID
  std::uint32_t epoch_ = 0;     ///< of these
};

}  // namespace cartvo::pipeline
