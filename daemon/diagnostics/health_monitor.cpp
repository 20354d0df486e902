// Builds the health message, published once a second.

#include "daemon/diagnostics/health_monitor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <unistd.h>

#include "common/host_clock.hpp"
#include "common/printable_text.hpp"
#include "common/statistics.hpp"
#include "common/units.hpp"

namespace cartvo::daemon {
namespace {

constexpr std::size_t kMaxTextSize = 200;  // bytes, so that the message fits into one Ethernet frame
constexpr std::size_t kMaxWindowPairs = 1024;
// The number of features has recovered from another program's burst after 5 s at 18 Hz, see FeatureBudget.
constexpr std::chrono::seconds kOverload{10};

float residentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  double total_pages = 0.0;
  double resident_pages = 0.0;
  statm >> total_pages >> resident_pages;
  return static_cast<float>(resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6);
}

std::string shortened(const std::string& text) {
  return std::string(utf8Prefix(text, kMaxTextSize));
}

template <typename Enumeration, typename... Constants>
constexpr bool areInOrder(Enumeration last, Constants... constants) {
  int next = 0;
  return ((constants == next++) && ...) && static_cast<int>(last) == next - 1;
}

// The enumerations have the values of the messages' constants.
static_assert(areInOrder(capture::CameraState::frozen, camera_health_t::CONNECTING,
                         camera_health_t::STREAMING, camera_health_t::STALLED, camera_health_t::REFUSED,
                         camera_health_t::ENDED, camera_health_t::FROZEN));
static_assert(areInOrder(capture::InstantSource::kernel, camera_health_t::FILE_INSTANTS,
                         camera_health_t::SENDER_REPORT, camera_health_t::ARRIVAL, camera_health_t::PICTURES,
                         camera_health_t::KERNEL));
static_assert(areInOrder(vo::IntegrityState::lost, health_t::TRACKING, health_t::STANDSTILL,
                         health_t::LEFT_FROZEN, health_t::RIGHT_FROZEN, health_t::BOTH_FROZEN,
                         health_t::LOST));

/// NaN if unknown.
float milliseconds(const std::optional<double>& nanoseconds) {
  return static_cast<float>(1e-6 * nanoseconds.value_or(std::numeric_limits<double>::quiet_NaN()));
}

camera_health_t cameraMessage(const capture::CameraHealth& health, const capture::ClockStatus::Camera& clock,
                              double frame_rate, double decode_ms) {
  camera_health_t message{};
  message.state = static_cast<std::int8_t>(health.state);
  message.instant_source = static_cast<std::int8_t>(health.instant_source);
  message.frames = static_cast<std::int64_t>(health.frames);
  message.damaged = static_cast<std::int64_t>(health.damaged);
  message.reconnections = static_cast<std::int64_t>(health.reconnections);
  message.frame_rate = static_cast<float>(frame_rate);
  message.decode_ms = static_cast<float>(decode_ms);
  message.latency_ms = milliseconds(clock.latency_ns);
  message.skew_ppm = static_cast<float>(1e6 * clock.skew);
  message.clock_steps = static_cast<std::int32_t>(clock.steps);
  message.last_error = shortened(health.last_error);
  return message;
}

/// `light`: HealthMonitor::lightProblem(). It comes before a frozen camera: a covered lens repeats its
/// picture.
std::string firstProblem(const HealthSnapshot& snapshot, const std::string& light) {
  if (!snapshot.problem.empty()) return snapshot.problem;
  const auto sends = [](const capture::CameraHealth& camera) {
    return camera.state == capture::CameraState::streaming || camera.state == capture::CameraState::frozen;
  };
  if (!light.empty() && sends(snapshot.left) && sends(snapshot.right)) return light;
  if (snapshot.left.state != capture::CameraState::streaming && !snapshot.left.last_error.empty()) {
    return "left camera: " + snapshot.left.last_error;
  }
  if (snapshot.right.state != capture::CameraState::streaming && !snapshot.right.last_error.empty()) {
    return "right camera: " + snapshot.right.last_error;
  }
  if (!snapshot.clock.problem.empty()) return snapshot.clock.problem;
  if (!snapshot.pairing.empty()) return snapshot.pairing;
  return snapshot.frame_rate;
}

/// A problem beside which the odometry is VALID. While it is not, it does not stand for the cause.
std::string lesserProblem(const HealthSnapshot& snapshot, bool is_valid, bool is_overloaded) {
  if (is_valid && !snapshot.recording.empty()) return snapshot.recording;
  if (!snapshot.left.advice.empty()) return "left camera: " + snapshot.left.advice;
  if (!snapshot.right.advice.empty()) return "right camera: " + snapshot.right.advice;
  if (!snapshot.clock.advice.empty() || !is_valid || !is_overloaded) return snapshot.clock.advice;
  return fmt::format(
      "the computer is too slow: it uses fewer than {} features to process each pair in time; stop other "
      "programs, or reduce odometry.features",
      snapshot.features);
}

void setClock(health_t& message, const capture::ClockStatus& clock) {
  const auto value = [](const std::optional<capture::OffsetEstimate>& estimate) {
    return estimate ? std::optional(estimate->value_ns) : std::nullopt;
  };
  message.clock_deviation_ms = milliseconds(clock.offset.stddev_ns);
  message.clock_by_reports_ms = milliseconds(value(clock.ntp));
  message.clock_by_pictures_ms = milliseconds(value(clock.visual));
}

void setCounts(health_t& message, const pipeline::PipelineCounts& counts) {
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
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  constexpr vo::EstimateWithStddev kNothing{kUnknown, kUnknown};
  const vo::RigCalibrationError rig =
      check.rig().value_or(vo::RigCalibrationError{kNothing, kNothing, kNothing, kNothing});
  message.right_late_ms = static_cast<float>(1e3 * rig.delay.value);
  message.right_late_deviation_ms = static_cast<float>(1e3 * rig.delay.stddev);
  const std::array<vo::EstimateWithStddev, 3> angles{rig.pitch, rig.yaw, rig.roll};
  for (std::size_t i = 0; i < angles.size(); ++i) {
    message.right_rotation_deg[i] = static_cast<float>(kDegreesPerRadian * angles[i].value);
    message.right_rotation_deviation_deg[i] = static_cast<float>(kDegreesPerRadian * angles[i].stddev);
  }
  const vo::ReadoutEstimates readouts = check.readouts().value_or(vo::ReadoutEstimates{kNothing, kNothing});
  message.left_readout_ms = static_cast<float>(1e3 * readouts.left.value);
  message.left_readout_deviation_ms = static_cast<float>(1e3 * readouts.left.stddev);
  message.right_readout_ms = static_cast<float>(1e3 * readouts.right.value);
  message.right_readout_deviation_ms = static_cast<float>(1e3 * readouts.right.stddev);
  message.self_check = shortened(check.message());
}

double decodeMilliseconds(const capture::FrameTimestamps& frame) {
  return static_cast<double>(frame.decoded_ns - frame.arrival_ns) * 1e-6;
}

}  // namespace

HealthMonitor::HealthMonitor(Clock::time_point start, const StatedReadouts& readouts)
    : start_(start), last_(start), last_all_features_(start), self_check_(readouts) {}

void HealthMonitor::addPair(const pipeline::PairResult& result, const odometry_t& message) {
  ++(message.status == odometry_t::VALID ? valid_ : invalid_);
  light_.add(result, message);
  self_check_.setTexture(light_.hasTexture());
  self_check_.update(result.estimate);
  window_.least_features = std::min(window_.least_features, result.features);
  window_.most_features = std::max(window_.most_features, result.features);
  window_.state = result.estimate.state;
  if (result.exceedsAlertLimit() && (!window_.worst || window_.worst->share() < result.worst->share()))
    window_.worst = result.worst;
  if (window_.latency.size() >= kMaxWindowPairs) return;
  window_.latency.push_back(static_cast<double>(message.publication_utime - message.arrival_utime) * 1e-3);
  window_.process.push_back(result.times.total * 1e3);
  window_.offset.push_back(static_cast<double>(result.offset_ns()) * 1e-6);
  window_.left_decode.push_back(decodeMilliseconds(result.left));
  window_.right_decode.push_back(decodeMilliseconds(result.right));
}

void HealthMonitor::addMissedPair() {
  ++invalid_;
}

health_t HealthMonitor::summarise(Clock::time_point now, const HealthSnapshot& snapshot) {
  const double seconds = std::max(std::chrono::duration<double>(now - last_).count(), 1e-3);
  const auto rate = [seconds](std::uint64_t count, std::uint64_t before) {
    return static_cast<double>(count - before) / seconds;
  };
  health_t message{};
  message.utime = wallClockNow() / 1000;
  message.version = CARTVO_VERSION;
  message.uptime_us = std::chrono::duration_cast<std::chrono::microseconds>(now - start_).count();
  message.left =
      cameraMessage(snapshot.left, snapshot.clock.cameras[0], rate(snapshot.left.frames, last_left_frames_),
                    percentile(window_.left_decode, 0.5));
  message.right =
      cameraMessage(snapshot.right, snapshot.clock.cameras[1],
                    rate(snapshot.right.frames, last_right_frames_), percentile(window_.right_decode, 0.5));
  setCounts(message, snapshot.counts);
  message.estimates_valid = valid_;
  message.estimates_invalid = invalid_;
  message.odometry_state = static_cast<std::int8_t>(window_.state);
  if (window_.worst) message.bound_exceeded = shortened(window_.worst->text());
  message.pair_rate = static_cast<float>(rate(snapshot.counts.pairs, last_pairs_));
  message.offset_ms = static_cast<float>(percentile(window_.offset, 0.5));
  message.latency_p50_ms = static_cast<float>(percentile(window_.latency, 0.5));
  message.latency_p99_ms = static_cast<float>(percentile(window_.latency, 0.99));
  message.process_ms = static_cast<float>(percentile(window_.process, 0.5));
  message.memory_mb = residentMegabytes();
  message.features_configured = snapshot.features;
  message.features_least = std::min(window_.least_features, snapshot.features);
  const bool has_pairs = window_.most_features > 0;
  if (!has_pairs || window_.most_features >= snapshot.features) last_all_features_ = now;
  setSelfCheck(message, self_check_);
  if (message.self_check.empty()) message.self_check = shortened(snapshot.advice);
  setClock(message, snapshot.clock);
  light_problem_ = light_.consumeProblem();
  message.problem = shortened(firstProblem(snapshot, light_problem_));
  if (message.problem.empty()) message.problem = shortened(self_check_.stereoFaultMessage());
  const bool is_valid = invalid_ - last_invalid_ <= valid_ - last_valid_;
  if (message.problem.empty())
    message.problem = shortened(lesserProblem(snapshot, is_valid, now - last_all_features_ >= kOverload));

  last_ = now;
  last_valid_ = valid_;
  last_invalid_ = invalid_;
  last_left_frames_ = snapshot.left.frames;
  last_right_frames_ = snapshot.right.frames;
  last_pairs_ = snapshot.counts.pairs;
  window_ = {};
  return message;
}

}  // namespace cartvo::daemon
