// Health, recording and replay as JSON for the status page.
#include "daemon/page/health_json.hpp"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/publish/message_names.hpp"

namespace cartvo::daemon {
namespace {

using Json = nlohmann::ordered_json;

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json cameraJson(const camera_health_t& camera) {
  return {{"state", cameraStateName(camera.state)},
          {"instants", instantSourceName(camera.instant_source)},
          {"frames", camera.frames},
          {"damaged", camera.damaged},
          {"reconnections", camera.reconnections},
          {"frame_rate", finite(camera.frame_rate)},
          {"decode_ms", finite(camera.decode_ms)},
          {"latency_ms", finite(camera.latency_ms)},
          {"skew_ppm", finite(camera.skew_ppm)},
          {"clock_steps", camera.clock_steps},
          {"last_error", camera.last_error}};
}

Json axesJson(const float (&values)[3]) {
  return Json::array({finite(values[0]), finite(values[1]), finite(values[2])});
}

/// The object's members without its braces.
std::string members(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.substr(1, text.size() - 2);
}

}  // namespace

std::string healthMembers(const health_t& health) {
  return members(
      {{"version", health.version},
       {"uptime_s", static_cast<double>(health.uptime_us) * 1e-6},
       {"left", cameraJson(health.left)},
       {"right", cameraJson(health.right)},
       {"pairs", health.pairs},
       {"dropped_no_partner", health.dropped_no_partner},
       {"dropped_damaged", health.dropped_damaged},
       {"dropped_out_of_order", health.dropped_out_of_order},
       {"dropped_overflow", health.dropped_overflow},
       {"dropped_clock", health.dropped_clock},
       {"refused_size", health.refused_size},
       {"pairs_skipped", health.pairs_skipped},
       {"estimates_valid", health.estimates_valid},
       {"estimates_invalid", health.estimates_invalid},
       {"odometry_state", odometryStateName(health.odometry_state)},
       {"pair_rate", finite(health.pair_rate)},
       {"offset_ms", finite(health.offset_ms)},
       {"offset_stddev_ms", finite(health.clock_deviation_ms)},
       {"clock_by_reports_ms", finite(health.clock_by_reports_ms)},
       {"clock_by_pictures_ms", finite(health.clock_by_pictures_ms)},
       {"right_late_ms", finite(health.right_late_ms)},
       {"right_late_stddev_ms", finite(health.right_late_deviation_ms)},
       {"right_rotation_deg", axesJson(health.right_rotation_deg)},
       {"right_rotation_stddev_deg", axesJson(health.right_rotation_deviation_deg)},
       {"readout_ms", Json::array({finite(health.left_readout_ms), finite(health.right_readout_ms)})},
       {"readout_stddev_ms",
        Json::array({finite(health.left_readout_deviation_ms), finite(health.right_readout_deviation_ms)})},
       {"latency_p50_ms", finite(health.latency_p50_ms)},
       {"latency_p99_ms", finite(health.latency_p99_ms)},
       {"process_ms", finite(health.process_ms)},
       {"memory_mb", finite(health.memory_mb)},
       {"features_configured", health.features_configured},
       {"features_least", health.features_least},
       {"self_check", health.self_check},
       {"bound_exceeded", health.bound_exceeded},
       {"problem", health.problem}});
}

std::string lightMembers(const TrafficLight& light) {
  return members(
      {{"light", {{"state", lightName(light.light)}, {"cause", light.cause}, {"topic", light.topic}}}});
}

std::string recordingMembers(const RecordingState& recording) {
  return members({{"recording",
                   {{"possible", recording.is_possible},
                    {"on", recording.is_recording},
                    {"folder", recording.folder},
                    {"text", recording.text},
                    {"pictures", recording.pictures},
                    {"bytes", recording.bytes},
                    {"dropped_pictures", recording.dropped_pictures}}}});
}

std::string replayMembers(const ReplayState& replay) {
  return members(
      {{"replay",
        {{"state", replay.state}, {"first", replay.first}, {"last", replay.last}, {"total", replay.total}}}});
}

std::string jsonText(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace cartvo::daemon
