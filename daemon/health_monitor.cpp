// What the daemon says of itself once a second.

#include "daemon/health_monitor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include <unistd.h>

#include "daemon/host_clock.hpp"

namespace cartvo {
namespace {

constexpr std::size_t kLongestText = 200;  // bytes, so that the message fits into one Ethernet frame
constexpr std::size_t kLargestWindow = 1024;
constexpr std::chrono::seconds kFirstReportsAreDue{10};  // cameras send their reports each few seconds

float megabytesResident() {
  std::ifstream statm("/proc/self/statm");
  double total_pages = 0.0;
  double resident_pages = 0.0;
  statm >> total_pages >> resident_pages;
  return static_cast<float>(resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6);
}

/// Cut at a UTF-8 character's beginning.
std::string shortened(std::string text) {
  if (text.size() <= kLongestText) return text;
  std::size_t end = kLongestText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
    --end;
  text.resize(end);
  return text;
}

std::int8_t stateCode(CameraState state) {
  switch (state) {
    case CameraState::connecting:
      return camera_health_t::CONNECTING;
    case CameraState::streaming:
      return camera_health_t::STREAMING;
    case CameraState::stalled:
      return camera_health_t::STALLED;
    case CameraState::refused:
      return camera_health_t::REFUSED;
    case CameraState::ended:
      return camera_health_t::ENDED;
  }
  return camera_health_t::CONNECTING;
}

std::int8_t sourceCode(InstantSource source) {
  switch (source) {
    case InstantSource::file:
      return camera_health_t::FILE_INSTANTS;
    case InstantSource::sender_report:
      return camera_health_t::SENDER_REPORT;
    case InstantSource::arrival:
      return camera_health_t::ARRIVAL;
  }
  return camera_health_t::ARRIVAL;
}

camera_health_t cameraMessage(const CameraHealth& health, double frame_rate, double decode_ms) {
  camera_health_t message{};
  message.state = stateCode(health.state);
  message.instant_source = sourceCode(health.instant_source);
  message.frames = static_cast<std::int64_t>(health.frames);
  message.damaged = static_cast<std::int64_t>(health.damaged);
  message.reconnections = static_cast<std::int64_t>(health.reconnections);
  message.frame_rate = static_cast<float>(frame_rate);
  message.decode_ms = static_cast<float>(decode_ms);
  message.last_error = shortened(health.last_error);
  return message;
}

std::string firstProblem(const HealthSnapshot& snapshot) {
  if (!snapshot.problem.empty()) return snapshot.problem;
  if (snapshot.left.state != CameraState::streaming && !snapshot.left.last_error.empty()) {
    return "left camera: " + snapshot.left.last_error;
  }
  if (snapshot.right.state != CameraState::streaming && !snapshot.right.last_error.empty()) {
    return "right camera: " + snapshot.right.last_error;
  }
  return snapshot.recording;
}

void setCounts(health_t& message, const PipelineCounts& counts) {
  message.pairs = static_cast<std::int64_t>(counts.pairs);
  message.dropped_no_partner = static_cast<std::int64_t>(counts.dropped_no_partner);
  message.dropped_damaged = static_cast<std::int64_t>(counts.dropped_damaged);
  message.dropped_out_of_order = static_cast<std::int64_t>(counts.dropped_out_of_order);
  message.dropped_overflow = static_cast<std::int64_t>(counts.dropped_overflow);
  message.dropped_clock = static_cast<std::int64_t>(counts.dropped_clock);
  message.refused_size = static_cast<std::int64_t>(counts.refused_size);
  message.pairs_skipped = static_cast<std::int64_t>(counts.skipped);
}

void setSelfCheck(health_t& message, const SelfCheck& check) {
  constexpr double kDegrees = 180.0 / 3.14159265358979323846;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  constexpr Checked kNothing{kUnknown, kUnknown};
  const RigCheck rig = check.rig().value_or(RigCheck{kNothing, kNothing, kNothing, kNothing});
  message.right_late_ms = static_cast<float>(1e3 * rig.delay.value);
  message.right_late_deviation_ms = static_cast<float>(1e3 * rig.delay.deviation);
  const std::array<Checked, 3> angles{rig.pitch, rig.yaw, rig.roll};
  for (std::size_t i = 0; i < angles.size(); ++i) {
    message.right_rotation_deg[i] = static_cast<float>(kDegrees * angles[i].value);
    message.right_rotation_deviation_deg[i] = static_cast<float>(kDegrees * angles[i].deviation);
  }
  message.self_check = shortened(check.sentence());
}

double decodeMilliseconds(const FrameInstants& frame) {
  return static_cast<double>(frame.decoded_ns - frame.arrival_ns) * 1e-6;
}

}  // namespace

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double rank = std::ceil(fraction * static_cast<double>(values.size())) - 1.0;
  const auto nth = values.begin() +
                   static_cast<std::ptrdiff_t>(std::clamp(rank, 0.0, static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

HealthMonitor::HealthMonitor(Clock::time_point start) : start_(start), last_(start) {}

void HealthMonitor::add(const PairResult& result, const odometry_t& message) {
  ++(message.status == odometry_t::VALID ? valid_ : invalid_);
  self_check_.note(result.estimate.rig);
  if (window_.latency.size() >= kLargestWindow) return;
  window_.latency.push_back(static_cast<double>(message.publication_utime - message.arrival_utime) * 1e-3);
  window_.process.push_back(result.times.total * 1e3);
  window_.offset.push_back(static_cast<double>(result.offset_ns()) * 1e-6);
  window_.left_decode.push_back(decodeMilliseconds(result.left));
  window_.right_decode.push_back(decodeMilliseconds(result.right));
}

std::string HealthMonitor::findClockProblem(Clock::time_point now, const HealthSnapshot& snapshot) {
  const bool differ = snapshot.left.state == CameraState::streaming &&
                      snapshot.right.state == CameraState::streaming &&
                      snapshot.left.instant_source != snapshot.right.instant_source;
  if (!differ) {
    clocks_differ_since_.reset();
    return {};
  }
  if (!clocks_differ_since_) clocks_differ_since_ = now;
  if (now - *clocks_differ_since_ < kFirstReportsAreDue) return {};
  const bool left_is_without = snapshot.left.instant_source == InstantSource::arrival;
  return std::string("no pairs: the ") + (left_is_without ? "left" : "right") +
         " camera sends no RTCP sender reports, the other does; connect to the camera itself and let it keep "
         "time "
         "by NTP, or set cameras.instants: arrival";
}

void HealthMonitor::addNoPair() {
  ++invalid_;
}

health_t HealthMonitor::summarise(Clock::time_point now, const HealthSnapshot& snapshot) {
  const double seconds = std::max(std::chrono::duration<double>(now - last_).count(), 1e-3);
  const auto rate = [seconds](std::uint64_t count, std::uint64_t before) {
    return static_cast<double>(count - before) / seconds;
  };
  health_t message{};
  message.utime = hostNow() / 1000;
  message.version = CARTVO_VERSION;
  message.uptime_us = std::chrono::duration_cast<std::chrono::microseconds>(now - start_).count();
  message.left = cameraMessage(snapshot.left, rate(snapshot.left.frames, last_left_frames_),
                               percentile(window_.left_decode, 0.5));
  message.right = cameraMessage(snapshot.right, rate(snapshot.right.frames, last_right_frames_),
                                percentile(window_.right_decode, 0.5));
  setCounts(message, snapshot.counts);
  message.estimates_valid = valid_;
  message.estimates_invalid = invalid_;
  message.pair_rate = static_cast<float>(rate(snapshot.counts.pairs, last_pairs_));
  message.offset_ms = static_cast<float>(percentile(window_.offset, 0.5));
  message.latency_p50_ms = static_cast<float>(percentile(window_.latency, 0.5));
  message.latency_p99_ms = static_cast<float>(percentile(window_.latency, 0.99));
  message.process_ms = static_cast<float>(percentile(window_.process, 0.5));
  message.memory_mb = megabytesResident();
  setSelfCheck(message, self_check_);
  clock_problem_ = findClockProblem(now, snapshot);
  message.problem = shortened(clock_problem_.empty() ? firstProblem(snapshot) : clock_problem_);

  last_ = now;
  last_left_frames_ = snapshot.left.frames;
  last_right_frames_ = snapshot.right.frames;
  last_pairs_ = snapshot.counts.pairs;
  window_ = {};
  return message;
}

}  // namespace cartvo
