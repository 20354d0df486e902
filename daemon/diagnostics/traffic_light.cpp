// The word for the state of odometry and cameras, with its cause.
#include "daemon/diagnostics/traffic_light.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/publish/message_names.hpp"
#include "vo_core/odometry_reason.hpp"

namespace cartvo::daemon {
namespace {

constexpr std::chrono::milliseconds kLostPair{300};  // one lost pair is not a fault

bool deliversPictures(const camera_health_t& camera) {
  return camera.state == camera_health_t::STREAMING || camera.state == camera_health_t::FROZEN;
}

TrafficLight cameraLight(const health_t& health) {
  const bool is_left = !deliversPictures(health.left), is_right = !deliversPictures(health.right);
  const camera_health_t& camera =
      is_left && (!is_right || !health.left.last_error.empty()) ? health.left : health.right;
  const char* name = is_left && is_right ? "both cameras" : (is_left ? "left camera" : "right camera");
  const std::string state = cameraStateName(camera.state);
  const std::string error = camera.last_error.empty() ? "" : ": " + camera.last_error;
  return {Light::no_camera, fmt::format("{} {}{}", name, state, error), "camera " + state};
}

/// The first reason, with its sentence. Where another one says why there is no pair, that one.
TrafficLight reasonLight(std::int32_t reasons) {
  if (reasons != odometry_t::REASON_NO_PAIR) reasons &= ~odometry_t::REASON_NO_PAIR;
  for (const vo::OdometryReasonText& text : vo::kOdometryReasons) {
    if ((reasons & static_cast<std::int32_t>(text.reason)) == 0) continue;
    std::string sentence = text.sentence;
    std::erase(sentence, '`');  // of Markdown
    return {Light::invalid, fmt::format("{}: {}", text.words, sentence), text.words};
  }
  return {Light::invalid, "no odometry message yet", "no messages"};
}

/// Names the problem to be fixed while odometry is valid.
TrafficLight validLight(const DaemonState& state) {
  const bool is_lost_pair = state.last_valid != state.last_message;  // its reasons tell nothing
  const bool is_standing = is_lost_pair ? state.health.odometry_state == health_t::STANDSTILL
                                        : (state.reasons & odometry_t::REASON_ZERO_VELOCITY) != 0;
  const Light light = is_standing ? Light::standstill : Light::driving;
  if (!state.health.problem.empty()) return {light, state.health.problem, ""};
  return {light, state.health.self_check, state.health.self_check.empty() ? "" : "self-check"};
}

}  // namespace

const char* lightName(Light light) {
  switch (light) {
    case Light::driving:
      return "driving";
    case Light::standstill:
      return "standstill";
    case Light::invalid:
      return "invalid";
    case Light::no_camera:
      break;
  }
  return "no_camera";
}

TrafficLight trafficLight(const DaemonState& state, DaemonState::Clock::time_point now) {
  const health_t& health = state.health;
  if (!state.stalled.empty())
    return {Light::invalid, "the " + state.stalled + " makes no progress; systemd restarts cartvod", ""};
  if (const std::optional<double> silence = state.silence(now))
    return {Light::invalid, fmt::format("no odometry message for {:.0f} s", *silence), "no messages"};
  const bool is_valid = state.last_valid == state.last_message || now - state.last_valid <= kLostPair;
  if (is_valid) return validLight(state);
  if (!deliversPictures(health.left) || !deliversPictures(health.right)) return cameraLight(health);
  if (!health.problem.empty()) return {Light::invalid, health.problem, reasonLight(state.reasons).topic};
  if ((state.reasons & odometry_t::REASON_BOUND) != 0 && !health.bound_exceeded.empty())
    return {Light::invalid, health.bound_exceeded, "bound above its alert limit"};
  return reasonLight(state.reasons);
}

}  // namespace cartvo::daemon
