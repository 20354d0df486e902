// What the journal says of one camera.

#include "daemon/camera_log.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace cartvo {
namespace {

const char* stateName(CameraState state) {
  switch (state) {
    case CameraState::connecting:
      return "connecting";
    case CameraState::streaming:
      return "streaming";
    case CameraState::stalled:
      return "stalled";
    case CameraState::refused:
      return "refused";
    case CameraState::ended:
      return "ended";
    case CameraState::frozen:
      return "frozen";
  }
  return "unknown";
}

}  // namespace

std::vector<CameraLog::Line> CameraLog::due(const CameraHealth& health, Clock::time_point now) {
  std::vector<Line> lines;
  const bool changed = std::exchange(state_, health.state) != health.state;
  untold_ += health.reconnections - std::exchange(reconnections_, health.reconnections);
  if (health.state == CameraState::streaming) {
    tellUnseen(health, now, lines);
    if (changed && lines.empty()) tellState(health, changed, now, lines);
  } else {
    untold_ = 0;  // that it has to be opened again is what the state's line says
    tellState(health, changed, now, lines);
  }
  return lines;
}

void CameraLog::tellState(const CameraHealth& health, bool changed, Clock::time_point now,
                          std::vector<Line>& lines) {
  const std::string state = fmt::format("{}: {}", name_, stateName(health.state));
  if (health.state == CameraState::streaming || health.last_error.empty()) {
    if (changed) lines.push_back({spdlog::level::info, state});
    return;
  }
  const std::string fault = state + ": " + health.last_error;
  if (changed) lasting_.forget(fault);
  if (std::string text = lasting_.due(fault, now); !text.empty())
    lines.push_back({spdlog::level::warn, std::move(text)});
}

/// It failed and was opened again between two looks.
void CameraLog::tellUnseen(const CameraHealth& health, Clock::time_point now, std::vector<Line>& lines) {
  if (!budget_.allows(now) || untold_ == 0) return;
  const std::string faults = untold_ == 1 ? "a fault" : fmt::format("{} faults, the last", untold_);
  lines.push_back({spdlog::level::warn,
                   fmt::format("{}: streaming again after {}: {}", name_, faults, health.last_error)});
  budget_.spend();
  untold_ = 0;
}

void CameraLog::note(const CameraHealth& health) {
  for (const Line& line : due(health, Clock::now()))
    spdlog::log(line.level, line.text);
}

}  // namespace cartvo
