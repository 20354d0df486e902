#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <cartvo/odometry_t.hpp>

#include "daemon/publish/message_sender.hpp"
#include "pipeline/pipeline.hpp"

namespace cartvo {

/// A longer gap in the recorded pace, as of a wrong time stamp, is shortened to this.
constexpr std::chrono::seconds kMaxRecordedPause{10};

/// Publishes a replay on CARTVO_ODOMETRY as a running daemon would: at the recorded pace, with instants that
/// are moved to now, so that a controller accepts the messages. Gaps of the recording are silence.
class LivePublisher {
 public:
  /// `url`: see daemon::GroupSender. `speed`: 2 publishes twice as fast; the velocities are not changed.
  LivePublisher(const std::string& url, double speed);

  /// Waits until the pair is due and publishes it.
  void publish(const pipeline::PairResult& result);

  /// Publishes all pairs again from the first, as a new epoch of the pose.
  void repeat();

 private:
  void begin(const odometry_t& first);
  void send(const odometry_t& recorded);
  /// A recorded instant moved to now, us.
  std::int64_t moved(std::int64_t recorded_utime) const;

  daemon::GroupSender sender_;
  double speed_;
  std::vector<odometry_t> recorded_;
  std::int64_t first_utime_ = 0;  ///< recorded instant of the first pair, us
  std::int64_t begin_utime_ = 0;  ///< its instant as published
  std::int64_t sequence_ = 0;
  std::int32_t epoch_ = 0;  ///< added to reset_counter
};

}  // namespace cartvo
