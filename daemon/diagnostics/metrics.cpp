// Health as text for Prometheus and for load balancers.

#include "daemon/diagnostics/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "daemon/publish/message_names.hpp"

namespace cartvo::daemon {
namespace {

template <typename Message, typename Value>
using Field = std::pair<const char*, Value Message::*>;

constexpr std::array<Field<health_t, std::int64_t>, 11> kCounters{
    {{"uptime_us", &health_t::uptime_us},
     {"pairs", &health_t::pairs},
     {"dropped_no_partner", &health_t::dropped_no_partner},
     {"dropped_damaged", &health_t::dropped_damaged},
     {"dropped_out_of_order", &health_t::dropped_out_of_order},
     {"dropped_overflow", &health_t::dropped_overflow},
     {"dropped_clock", &health_t::dropped_clock},
     {"refused_size", &health_t::refused_size},
     {"pairs_skipped", &health_t::pairs_skipped},
     {"estimates_valid", &health_t::estimates_valid},
     {"estimates_invalid", &health_t::estimates_invalid}}};
constexpr std::array<Field<health_t, float>, 15> kGauges{
    {{"pair_rate", &health_t::pair_rate},
     {"offset_ms", &health_t::offset_ms},
     {"latency_p50_ms", &health_t::latency_p50_ms},
     {"latency_p99_ms", &health_t::latency_p99_ms},
     {"process_ms", &health_t::process_ms},
     {"memory_mb", &health_t::memory_mb},
     {"clock_deviation_ms", &health_t::clock_deviation_ms},
     {"clock_by_reports_ms", &health_t::clock_by_reports_ms},
     {"clock_by_pictures_ms", &health_t::clock_by_pictures_ms},
     {"right_late_ms", &health_t::right_late_ms},
     {"right_late_deviation_ms", &health_t::right_late_deviation_ms},
     {"left_readout_ms", &health_t::left_readout_ms},
     {"left_readout_deviation_ms", &health_t::left_readout_deviation_ms},
     {"right_readout_ms", &health_t::right_readout_ms},
     {"right_readout_deviation_ms", &health_t::right_readout_deviation_ms}}};
constexpr std::array<Field<camera_health_t, std::int64_t>, 3> kCameraCounters{
    {{"frames", &camera_health_t::frames},
     {"damaged", &camera_health_t::damaged},
     {"reconnections", &camera_health_t::reconnections}}};
constexpr std::array<Field<camera_health_t, float>, 4> kCameraGauges{
    {{"frame_rate", &camera_health_t::frame_rate},
     {"decode_ms", &camera_health_t::decode_ms},
     {"latency_ms", &camera_health_t::latency_ms},
     {"skew_ppm", &camera_health_t::skew_ppm}}};

/// A number as Prometheus reads it.
std::string numberText(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0.0 ? "+Inf" : "-Inf";
  return fmt::format("{}", value);
}

/// Writes metrics, each with its type.
class Writer {
 public:
  void begin(const std::string& name, const char* type) {
    name_ = name;
    fmt::format_to(std::back_inserter(text_), "# TYPE cartvo_{} {}\n", name, type);
  }
  /// `labels`: what follows the name: nothing, or such as {camera="left"}.
  void add(double value, const std::string& labels) {
    fmt::format_to(std::back_inserter(text_), "cartvo_{}{} {}\n", name_, labels, numberText(value));
  }
  void addOne(const std::string& name, const char* type, double value) {
    begin(name, type);
    add(value, "");
  }
  /// One value for each camera.
  void addCameras(const std::string& name, const char* type, double left, double right) {
    begin(name, type);
    add(left, "{camera=\"left\"}");
    add(right, "{camera=\"right\"}");
  }
  std::string take() { return std::move(text_); }

 private:
  std::string name_, text_;
};

void writeCameras(Writer& writer, const camera_health_t& left, const camera_health_t& right) {
  for (const auto& [name, field] : kCameraCounters) {
    writer.addCameras(std::string("camera_") + name, "counter", static_cast<double>(left.*field),
                      static_cast<double>(right.*field));
  }
  for (const auto& [name, field] : kCameraGauges)
    writer.addCameras(std::string("camera_") + name, "gauge", left.*field, right.*field);
  writer.addCameras("camera_clock_steps", "counter", left.clock_steps, right.clock_steps);
  writer.addCameras("camera_state", "gauge", left.state, right.state);
  writer.addCameras("camera_instant_source", "gauge", left.instant_source, right.instant_source);
}

void writeRotations(Writer& writer, const char* name, const float (&values)[3]) {
  writer.begin(name, "gauge");
  writer.add(values[0], "{axis=\"pitch\"}");
  writer.add(values[1], "{axis=\"yaw\"}");
  writer.add(values[2], "{axis=\"roll\"}");
}

void writeBounds(Writer& writer, const PairTotals& totals) {
  const auto write = [&writer](const char* name, const Eigen::Vector3d& bounds) {
    writer.begin(name, "gauge");
    writer.add(bounds.x(), "{axis=\"x\"}");
    writer.add(bounds.y(), "{axis=\"y\"}");
    writer.add(bounds.z(), "{axis=\"z\"}");
  };
  write("velocity_bound", totals.level.velocity);
  write("angular_rate_bound", totals.level.angular_rate);
  write("motion_bound", totals.level.motion);
  write("rotation_bound", totals.level.rotation);
  writer.addOne("quality", "gauge", totals.quality);
  writer.addOne("pairs_above_alert_limit", "counter", static_cast<double>(totals.above_alert_limit));
}

void writeTotals(Writer& writer, const PairTotals& totals) {
  writer.addOne("processed_pairs", "counter", static_cast<double>(totals.pairs));
  writer.addOne("process_seconds", "counter", totals.process);
  writer.addOne("queue_seconds", "counter", totals.queue);
  writer.addCameras("decode_seconds", "counter", totals.decode[0], totals.decode[1]);
  writer.begin("stage_seconds", "counter");
  for (int i = 0; i < vo::kStageCount; ++i) {
    writer.add(totals.stages[static_cast<std::size_t>(i)],
               fmt::format("{{stage=\"{}\"}}", vo::stageName(static_cast<vo::Stage>(i))));
  }
  writer.begin("latency_seconds", "histogram");
  for (std::size_t i = 0; i < kLatencyBounds.size(); ++i) {
    writer.add(static_cast<double>(totals.latency_counts[i]),
               fmt::format("_bucket{{le=\"{}\"}}", kLatencyBounds[i]));
  }
  writer.add(static_cast<double>(totals.pairs), "_bucket{le=\"+Inf\"}");
  writer.add(totals.latency, "_sum");
  writer.add(static_cast<double>(totals.pairs), "_count");
}

const char* waitingCamera(const health_t& health) {
  const auto waits = [](const camera_health_t& camera) {
    return camera.state == camera_health_t::CONNECTING || camera.state == camera_health_t::STALLED;
  };
  if (waits(health.left)) return waits(health.right) ? "both cameras" : "the left camera";
  return waits(health.right) ? "the right camera" : nullptr;
}

}  // namespace

void PairTotals::add(const pipeline::PairResult& result, const odometry_t& message) {
  const auto seconds = [](std::int64_t ns) {
    return 1e-9 * static_cast<double>(std::max<std::int64_t>(ns, 0));
  };
  const double pair_latency = seconds(1000 * (message.publication_utime - message.arrival_utime));
  const double both_decoded =
      seconds(std::max(result.left.decoded_ns, result.right.decoded_ns) - result.arrival_ns());
  ++pairs;
  level = result.level;
  quality = message.quality;
  if (result.exceedsAlertLimit()) ++above_alert_limit;
  for (std::size_t i = 0; i < stages.size(); ++i)
    stages[i] += result.times.stages[i];
  process += result.times.total;
  decode[0] += seconds(result.left.decoded_ns - result.left.arrival_ns);
  decode[1] += seconds(result.right.decoded_ns - result.right.arrival_ns);
  queue += std::max(pair_latency - both_decoded - result.times.total, 0.0);
  latency += pair_latency;
  for (std::size_t i = 0; i < kLatencyBounds.size(); ++i) {
    if (pair_latency <= kLatencyBounds[i]) ++latency_counts[i];
  }
}

std::string metricsText(const health_t& health, const PairTotals& totals) {
  Writer writer;
  writer.begin("info", "gauge");
  writer.add(1, fmt::format("{{version=\"{}\"}}", health.version));
  writer.addOne("utime", "gauge", static_cast<double>(health.utime));
  for (const auto& [name, field] : kCounters)
    writer.addOne(name, "counter", static_cast<double>(health.*field));
  for (const auto& [name, field] : kGauges)
    writer.addOne(name, "gauge", health.*field);
  writer.addOne("features_configured", "gauge", health.features_configured);
  writer.addOne("features_least", "gauge", health.features_least);
  writer.addOne("odometry_state", "gauge", health.odometry_state);
  writeRotations(writer, "right_rotation_deg", health.right_rotation_deg);
  writeRotations(writer, "right_rotation_deviation_deg", health.right_rotation_deviation_deg);
  writeCameras(writer, health.left, health.right);
  writer.addOne("has_problem", "gauge", health.problem.empty() ? 0 : 1);
  writer.addOne("has_self_check_fault", "gauge", health.self_check.empty() ? 0 : 1);
  writeTotals(writer, totals);
  writeBounds(writer, totals);
  return writer.take();
}

HealthAnswer healthAnswer(const DaemonState& state, DaemonState::Clock::time_point now) {
  constexpr std::chrono::seconds kLongestInvalid{1};
  if (const std::optional<double> silence = state.silence(now))
    return {false, fmt::format("stalled: no odometry message for {:.0f} s", *silence)};
  if (!state.stalled.empty()) return {false, "stalled: the " + state.stalled + " makes no progress"};
  if (now - state.last_valid <= kLongestInvalid) return {true, "valid"};
  const health_t& health = state.health;
  const std::string& cause = health.problem.empty() ? health.bound_exceeded : health.problem;
  const std::string problem = cause.empty() ? "" : ": " + cause;
  const bool is_refused =
      health.left.state == camera_health_t::REFUSED || health.right.state == camera_health_t::REFUSED;
  if (const char* camera = waitingCamera(health); camera != nullptr && !is_refused)
    return {true, std::string("waiting for ") + camera + problem};
  return {false, fmt::format("invalid ({}; {}){}", reasonNames(state.reasons),
                             odometryStateName(health.odometry_state), problem)};
}

HealthAnswer readyAnswer(const DaemonState& state, DaemonState::Clock::time_point now) {
  HealthAnswer answer = healthAnswer(state, now);
  if (!answer.is_healthy) return answer;
  const health_t& health = state.health;
  for (const auto& [name, camera] : {std::pair("left", &health.left), std::pair("right", &health.right)}) {
    if (camera->state == camera_health_t::STREAMING) continue;
    return {false, fmt::format("the {} camera is {}{}{}", name, cameraStateName(camera->state),
                               camera->last_error.empty() ? "" : ": ", camera->last_error)};
  }
  return answer;
}

}  // namespace cartvo::daemon
