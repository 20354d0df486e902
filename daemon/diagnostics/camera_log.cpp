// Log lines about the health of one camera.

#include "daemon/diagnostics/camera_log.hpp"

#include <utility>

#include <fmt/format.h>

#include "daemon/diagnostics/journal.hpp"

namespace cartvo::daemon {
namespace {

const char* stateName(capture::CameraState state) {
  switch (state) {
    case capture::CameraState::connecting:
      return "connecting";
    case capture::CameraState::streaming:
      return "streaming";
    case capture::CameraState::stalled:
      return "stalled";
    case capture::CameraState::refused:
      return "refused";
    case capture::CameraState::ended:
      return "ended";
    case capture::CameraState::frozen:
      return "frozen";
  }
  return "unknown";
}

}  // namespace

std::vector<CameraLog::Line> CameraLog::due(const capture::CameraHealth& health, Clock::time_point now) {
  std::vector<Line> lines;
  const bool changed = std::exchange(state_, health.state) != health.state;
  unlogged_reconnections_ += health.reconnections - std::exchange(reconnections_, health.reconnections);
  if (health.state == capture::CameraState::streaming) {
    addMissedFaultLine(health, now, lines);
    if (changed && lines.empty()) addStateLine(health, changed, now, lines);
  } else {
    unlogged_reconnections_ = 0;  // the state's line covers them
    addStateLine(health, changed, now, lines);
  }
  return lines;
}

void CameraLog::addStateLine(const capture::CameraHealth& health, bool changed, Clock::time_point now,
                             std::vector<Line>& lines) {
  const std::string state = fmt::format("{}: {}", name_, stateName(health.state));
  if (health.state == capture::CameraState::streaming || health.last_error.empty()) {
    if (changed) lines.push_back({spdlog::level::info, state});
    return;
  }
  const std::string fault = state + ": " + health.last_error;
  if (changed) faults_.forget(fault);
  if (std::string text = faults_.due(fault, now); !text.empty())
    lines.push_back({spdlog::level::warn, std::move(text)});
}

/// Adds a line if the camera failed and was reopened between two polls.
void CameraLog::addMissedFaultLine(const capture::CameraHealth& health, Clock::time_point now,
                                   std::vector<Line>& lines) {
  if (!budget_.allows(now) || unlogged_reconnections_ == 0) return;
  const std::string faults =
      unlogged_reconnections_ == 1 ? "a fault" : fmt::format("{} faults, the last", unlogged_reconnections_);
  lines.push_back({spdlog::level::warn,
                   fmt::format("{}: streaming again after {}: {}", name_, faults, health.last_error)});
  budget_.spend();
  unlogged_reconnections_ = 0;
}

void CameraLog::log(const capture::CameraHealth& health) {
  for (const Line& line : due(health, Clock::now()))
    logEvent(line.level, line.text,
             {{"CARTVO_EVENT", "camera_state"},
              {"CARTVO_CAMERA", name_.substr(0, name_.find(' '))},
              {"CARTVO_CAMERA_STATE", stateName(health.state)}});
}

}  // namespace cartvo::daemon
