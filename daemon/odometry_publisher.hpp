#pragma once

#include <chrono>
#include <cstdint>

#include <cartvo/odometry_t.hpp>

#include "daemon/pipeline.hpp"

namespace lcm {
class LCM;
}

namespace cartvo {

/// The bits of odometry_t.reasons that stand for the odometry's reasons.
std::int32_t reasonBits(const OdometryReasons& reasons);

/// The message for one pair. What an invalid estimate holds is said in daemon/messages/odometry_t.lcm.
odometry_t odometryMessage(const PairResult& result);

/// The message for a pair that did not come, with the pose of `last`.
odometry_t odometryMessage(const NoPair& no_pair, const odometry_t& last);

/// Sends CARTVO_ODOMETRY: one message for each pair and for each pair that did not come, numbered without a
/// gap.
class OdometryPublisher {
 public:
  /// `lcm` is borrowed and must outlive the publisher.
  OdometryPublisher(lcm::LCM& lcm, std::chrono::milliseconds time_to_live);

  /// Each returns the message as it was sent (or would have been).
  const odometry_t& publish(const PairResult& result);
  const odometry_t& publish(const NoPair& no_pair);

  /// Messages that the operating system refused to send.
  std::uint64_t failures() const { return failures_; }

 private:
  const odometry_t& send(const odometry_t& message);

  lcm::LCM& lcm_;
  std::chrono::microseconds time_to_live_;
  odometry_t last_;
  std::int64_t next_sequence_ = 0;
  std::uint64_t failures_ = 0;
};

}  // namespace cartvo
