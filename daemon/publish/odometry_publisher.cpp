// Builds and publishes the odometry message.

#include "daemon/publish/odometry_publisher.hpp"

#include <algorithm>
#include <limits>
#include <random>

#include <cartvo/client.hpp>

#include "common/host_clock.hpp"
#include "daemon/publish/lcm_connection.hpp"

namespace cartvo::daemon {
namespace {

constexpr std::int64_t kNanosecondsPerMicrosecond = 1000;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

void setPose(odometry_t& message, const Eigen::Isometry3d& T_world_body) {
  Eigen::Quaterniond q(T_world_body.rotation());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  Eigen::Map<Eigen::Vector3d>(message.position_world_body) = T_world_body.translation();
  Eigen::Map<Eigen::Vector4d>(message.orientation_world_body) << q.w(), q.x(), q.y(), q.z();
}

void setMatrix(double (&rows)[36], const vo::Matrix6d& matrix) {
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{rows} = matrix;
}

template <std::size_t count>
void setUnknown(double (&values)[count]) {
  std::fill(std::begin(values), std::end(values), kUnknown);
}

void setBounds(odometry_t& message, const pipeline::ProtectionLevel& level) {
  Eigen::Map<Eigen::Vector3d>(message.velocity_bound) = level.velocity;
  Eigen::Map<Eigen::Vector3d>(message.angular_rate_bound) = level.angular_rate;
  Eigen::Map<Eigen::Vector3d>(message.motion_bound) = level.motion;
  Eigen::Map<Eigen::Vector3d>(message.rotation_bound) = level.rotation;
}

/// Sets to NaN all fields of an INVALID message that could be mistaken for measurements.
void eraseMeasurements(odometry_t& message) {
  message.quality = 0;
  setUnknown(message.pose_covariance_body);
  setUnknown(message.velocity_body);
  setUnknown(message.angular_velocity_body);
  setUnknown(message.twist_covariance_body);
  setUnknown(message.acceleration_body);
  setUnknown(message.acceleration_covariance_body);
  setBounds(message, {});
}

/// Positive: 0 stands for a replay.
std::int64_t randomSourceId() {
  std::random_device random;
  return std::uniform_int_distribution<std::int64_t>(1, std::numeric_limits<std::int64_t>::max())(random);
}

std::int32_t noPairBits(pipeline::NoPairCause cause) {
  constexpr std::int32_t kNoPair = odometry_t::REASON_NO_PAIR;
  constexpr std::int32_t kDamagedFrame = odometry_t::REASON_DAMAGED_FRAME;
  constexpr std::int32_t kWrongSize = odometry_t::REASON_WRONG_SIZE;
  switch (cause) {
    case pipeline::NoPairCause::damaged:
      return kNoPair | kDamagedFrame;
    case pipeline::NoPairCause::wrong_size:
      return kNoPair | kWrongSize;
    case pipeline::NoPairCause::no_frames:
    case pipeline::NoPairCause::no_partner:
      break;
  }
  return kNoPair;
}

}  // namespace

odometry_t odometryMessage(const pipeline::PairResult& result) {
  const vo::OdometryEstimate& estimate = result.estimate;
  odometry_t message{};
  message.utime = result.left.exposure_ns / kNanosecondsPerMicrosecond;
  message.arrival_utime = result.arrival_ns() / kNanosecondsPerMicrosecond;
  message.offset_us = result.offset_ns() / kNanosecondsPerMicrosecond;
  message.reasons = static_cast<std::int32_t>(estimate.reasons.bits());
  message.reset_counter = static_cast<std::int32_t>(estimate.reset_counter);
  message.features = estimate.counts.detected;
  message.tracked = estimate.counts.tracked;
  message.inliers = estimate.counts.inliers;
  setPose(message, result.motion.T_world_body);
  setMatrix(message.pose_covariance_body, result.motion.pose_covariance);
  Eigen::Map<Eigen::Vector3d>(message.velocity_body) = result.motion.velocity;
  Eigen::Map<Eigen::Vector3d>(message.angular_velocity_body) = result.motion.angular_velocity;
  setMatrix(message.twist_covariance_body, result.motion.twist_covariance);
  Eigen::Map<Eigen::Vector3d>(message.acceleration_body) = result.motion.acceleration;
  Eigen::Map<Eigen::Matrix3d>(message.acceleration_covariance_body) = result.motion.acceleration_covariance;

  if (result.isValid()) {
    message.status = odometry_t::VALID;
    message.quality = static_cast<std::int8_t>(result.worst->quality());
    setBounds(message, result.level);
    return message;
  }
  message.status = odometry_t::INVALID;
  eraseMeasurements(message);
  if (result.exceedsAlertLimit()) {
    message.reasons |= odometry_t::REASON_BOUND;
    setBounds(message, result.level);
  } else if (estimate.valid) {
    message.reasons |= odometry_t::REASON_TIME_STEP;  // a motion without a velocity
  }
  return message;
}

odometry_t odometryMessage(const pipeline::NoPair& no_pair, const odometry_t& last) {
  odometry_t message{};
  message.utime = no_pair.due_ns / kNanosecondsPerMicrosecond;
  message.status = odometry_t::INVALID;
  message.reasons = noPairBits(no_pair.cause);
  message.reset_counter = last.reset_counter;
  std::copy(std::begin(last.position_world_body), std::end(last.position_world_body),
            std::begin(message.position_world_body));
  std::copy(std::begin(last.orientation_world_body), std::end(last.orientation_world_body),
            std::begin(message.orientation_world_body));
  eraseMeasurements(message);
  return message;
}

OdometryPublisher::OdometryPublisher(MessageSender& sender, std::chrono::milliseconds time_to_live)
    : sender_(sender), time_to_live_(time_to_live), source_id_(randomSourceId()), last_{} {
  setPose(last_, Eigen::Isometry3d::Identity());
}

const odometry_t& OdometryPublisher::publish(const pipeline::PairResult& result) {
  return send(odometryMessage(result));
}

const odometry_t& OdometryPublisher::publish(const pipeline::NoPair& no_pair) {
  return send(odometryMessage(no_pair, last_));
}

const odometry_t& OdometryPublisher::send(const odometry_t& message) {
  last_ = message;
  last_.source_id = source_id_;
  last_.sequence = next_sequence_++;
  last_.time_to_live_us = time_to_live_.count();
  const std::int64_t correction = hostClockCorrection();
  last_.utime += correction / kNanosecondsPerMicrosecond;
  if (last_.arrival_utime != 0) last_.arrival_utime += correction / kNanosecondsPerMicrosecond;
  last_.publication_utime = (hostNow() + correction) / kNanosecondsPerMicrosecond;
  if (last_.status == odometry_t::VALID && last_.utime > last_.publication_utime) {
    last_.status = odometry_t::INVALID;  // no picture was exposed after now
    last_.reasons = odometry_t::REASON_OFFSET_UNCERTAIN;
    eraseMeasurements(last_);
  }
  last_.crc32 = client::contentCrc(last_);
  if (!sender_.publish(kOdometryChannel, last_)) ++failures_;
  return last_;
}

}  // namespace cartvo::daemon
