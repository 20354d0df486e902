// Bounds of the errors of a published motion.
#include "pipeline/protection_level.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/exact_text.hpp"
#include "vo_core/geometry/pose_drift.hpp"

namespace cartvo::pipeline {
namespace {

constexpr double kSecond = 1.0;
constexpr double kInstantTolerance = 1e-3;  // s; 18 periods of 18 Hz are a second in spite of rounding

/// Words for the text about a bound: the operator sees no axes.
struct QuantityWords {
  std::array<const char*, 3> axes;
  const char* is_known;
  const char* unit;
  double unit_factor;
};

const QuantityWords& wordsOf(BoundedQuantity quantity) {
  static constexpr std::array<QuantityWords, 4> kWords{{
      {{"forward velocity", "sideways velocity", "vertical velocity"}, "is known to", "m/s", 1.0},
      {{"roll rate", "pitch rate", "yaw rate"}, "is known to", "deg/s", kDegreesPerRadian},
      {{"forward motion", "sideways motion", "vertical motion"}, "of the last second is known to", "m", 1.0},
      {{"roll", "pitch", "yaw"}, "of the last second is known to", "deg", kDegreesPerRadian},
  }};
  return kWords[static_cast<std::size_t>(quantity)];
}

/// Bounds by the diagonal of a covariance, from `row` on, and what is added to them.
Eigen::Vector3d boundsOf(const vo::Matrix6d& covariance, int row, double added) {
  return (kBoundFactor * covariance.diagonal().segment<3>(row).cwiseSqrt()).array() + added;
}

}  // namespace

int LimitedBound::quality() const {
  if (isExceeded()) return 0;
  return std::max(1, static_cast<int>(std::lround(100.0 * (1.0 - share()))));
}

std::string LimitedBound::text() const {
  const QuantityWords& words = wordsOf(quantity);
  const auto in_unit = [&words](double value) {
    return fixedText(words.unit_factor * value, 2) + " " + words.unit;
  };
  return std::string(words.axes[static_cast<std::size_t>(axis)]) + " " + words.is_known + " " +
         in_unit(bound) + ", alert limit " + in_unit(limit);
}

LimitedBound worstBound(const ProtectionLevel& level, const AlertLimits& limits) {
  const std::array<std::pair<const Eigen::Vector3d*, double>, 4> bounds{{
      {&level.velocity, limits.velocity},
      {&level.angular_rate, limits.angular_rate},
      {&level.motion, limits.motion},
      {&level.rotation, limits.rotation},
  }};
  LimitedBound worst{.limit = limits.velocity};
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const auto& [values, limit] = bounds[i];
    for (int axis = 0; axis < 3; ++axis) {
      const double bound = (*values)[axis];
      const LimitedBound limited{static_cast<BoundedQuantity>(i), axis, bound, limit};
      if (std::isnan(bound)) return limited;
      if (limited.share() > worst.share()) worst = limited;
    }
  }
  return worst;
}

ProtectionLevels::ProtectionLevels(const Eigen::Isometry3d& T_body_rectified, double scale_stddev,
                                   const vo::UncertaintySettings& uncertainty)
    : T_body_rectified_(T_body_rectified), scale_stddev_(scale_stddev), uncertainty_(uncertainty) {}

ProtectionLevel ProtectionLevels::update(const vo::OdometryEstimate& estimate, const BodyMotion& motion) {
  if (estimate.reset_counter != epoch_) {
    motions_.clear();
    newest_valid_ = false;
  }
  epoch_ = estimate.reset_counter;
  ProtectionLevel level;
  if (!estimate.valid || !(estimate.time_step > 0.0)) return level;
  add(estimate);
  const vo::Matrix6d Ad = vo::adjoint(T_body_rectified_);
  const LastSecond last = lastSecond();
  const vo::Matrix6d covariance = Ad * last.covariance * Ad.transpose();
  // For a second after it has stopped, a cart sways on its springs by less than standstill is recognised by.
  const bool stands =
      std::all_of(motions_.begin(), motions_.end(), [](const Motion& part) { return part.stands; });
  // Velocities that are extrapolated to the exposure err by a third of the jerk times the step squared.
  const double by_jerk = stands ? 0.0 : kUnannouncedJerk / 3.0 * estimate.time_step * estimate.time_step;
  level.velocity = boundsOf(motion.twist_covariance, 0, by_jerk);
  level.angular_rate = boundsOf(motion.twist_covariance, 3, std::min(by_jerk, kKerbRate));
  level.motion = boundsOf(covariance, 0, kMotionFloor + kWayShare * last.distance);
  level.rotation = boundsOf(covariance, 3, kRotationFloor);
  return level;
}

void ProtectionLevels::add(const vo::OdometryEstimate& estimate) {
  motions_.push_back({newest_valid_, estimate.reasons == vo::OdometryReason::zero_velocity,
                      estimate.time_step, estimate.T_previous_current, estimate.motion_covariance});
  newest_valid_ = false;
  double duration = 0.0;
  for (const Motion& motion : motions_)
    duration += motion.time_step;
  while (motions_.size() > 1 && duration > kSecond + kInstantTolerance) {
    duration -= motions_.front().time_step;
    motions_.pop_front();
  }
}

/// In the axes of the rectified camera. An error of the rig's scale makes all distances too long by the same
/// fraction.
ProtectionLevels::LastSecond ProtectionLevels::lastSecond() const {
  vo::PoseUncertainty uncertainty;
  // The first motions of a track are uncertain because they are the first, not because they drift.
  uncertainty.drift = uncertainty_.drift_ratio * motions_.back().covariance;
  Eigen::Isometry3d T_start_current = Eigen::Isometry3d::Identity();
  const auto oldest_valid = std::find_if(motions_.begin(), std::prev(motions_.end()),
                                         [](const Motion& motion) { return motion.starts_valid; });
  for (auto it = oldest_valid; it != motions_.end(); ++it) {
    const Motion& motion = *it;
    uncertainty = vo::afterMotion(uncertainty, motion.T_previous_current, motion.covariance, uncertainty_);
    T_start_current = T_start_current * motion.T_previous_current;
  }
  const vo::Vector6d by_scale = scaleError(T_start_current, scale_stddev_);
  return {uncertainty.pose + by_scale * by_scale.transpose(), T_start_current.translation().norm()};
}

}  // namespace cartvo::pipeline
