// Publishes a replay at the recorded pace with instants of now.
#include "tools/replay/live_publisher.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "common/host_clock.hpp"
#include "daemon/publish/lcm_connection.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "daemon/service/configuration.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kNanosecondsPerMicrosecond = 1000;

std::int64_t nowUtime() {
  return wallClockNow() / kNanosecondsPerMicrosecond;
}

}  // namespace

LivePublisher::LivePublisher(const std::string& url, double speed) : sender_(url), speed_(speed) {}

void LivePublisher::publish(const pipeline::PairResult& result) {
  recorded_.push_back(daemon::odometryMessage(result));
  if (recorded_.size() == 1) begin(recorded_.front());
  send(recorded_.back());
}

void LivePublisher::repeat() {
  if (recorded_.empty()) return;
  epoch_ += 1 + recorded_.back().reset_counter;
  begin(recorded_.front());
  for (const odometry_t& message : recorded_)
    send(message);
}

void LivePublisher::begin(const odometry_t& first) {
  first_utime_ = first.utime;
  begin_utime_ = nowUtime();
}

std::int64_t LivePublisher::moved(std::int64_t recorded_utime) const {
  return begin_utime_ + std::llround(static_cast<double>(recorded_utime - first_utime_) / speed_);
}

void LivePublisher::send(const odometry_t& recorded) {
  begin_utime_ -= std::max<std::int64_t>(
      moved(recorded.utime) - nowUtime() - std::chrono::microseconds(kMaxRecordedPause).count(), 0);
  odometry_t message = recorded;
  message.utime = moved(recorded.utime);
  // Image folders have no arrival times.
  if (recorded.arrival_utime != 0) message.arrival_utime = moved(recorded.arrival_utime);
  const std::int64_t due = std::max(message.utime, message.arrival_utime);
  std::this_thread::sleep_for(std::chrono::microseconds(std::max<std::int64_t>(due - nowUtime(), 0)));
  message.sequence = sequence_++;
  message.reset_counter += epoch_;
  message.time_to_live_us = std::chrono::microseconds(daemon::Configuration{}.time_to_live).count();
  message.publication_utime = nowUtime();
  sender_.publish(daemon::kOdometryChannel, message);
}

}  // namespace cartvo
