#pragma once

#include <chrono>
#include <cstdint>

#include <cartvo/odometry_t.hpp>

#include "daemon/publish/message_sender.hpp"
#include "pipeline/pipeline.hpp"

// Odometry messages: building and publishing over LCM.

namespace cartvo::daemon {

/// Builds the message for one pair, with the source id of a replay. daemon/messages/odometry_t.lcm defines
/// the content of an invalid one.
odometry_t odometryMessage(const pipeline::PairResult& result);

/// Builds the message for a pair that did not arrive, with the pose of `last`.
odometry_t odometryMessage(const pipeline::NoPair& no_pair, const odometry_t& last);

/// Publishes CARTVO_ODOMETRY: one message for each pair and for each pair that did not arrive, numbered
/// without gaps, from a source id of its own.
class OdometryPublisher {
 public:
  /// `sender` is borrowed and must outlive the publisher.
  OdometryPublisher(MessageSender& sender, std::chrono::milliseconds time_to_live);

  /// Both return the message as it was sent, or as it would have been if sending failed.
  const odometry_t& publish(const pipeline::PairResult& result);
  const odometry_t& publish(const pipeline::NoPair& no_pair);

  /// Of the messages from now on.
  void setTimeToLive(std::chrono::milliseconds time_to_live) { time_to_live_ = time_to_live; }

  std::int64_t sourceId() const { return source_id_; }

  /// Number of messages that the operating system refused to send.
  std::uint64_t failures() const { return failures_; }

 private:
  const odometry_t& send(const odometry_t& message);

  MessageSender& sender_;
  std::chrono::microseconds time_to_live_;
  std::int64_t source_id_;
  odometry_t last_;
  std::int64_t next_sequence_ = 0;
  std::uint64_t failures_ = 0;
};

}  // namespace cartvo::daemon
