#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <spdlog/common.h>

#include "capture/camera_source.hpp"
#include "daemon/line_budget.hpp"
#include "daemon/log.hpp"

namespace cartvo {

/// Tells of one camera, whose health is looked at now and then, what an administrator wants to read in the
/// journal: each change of its state; what is wrong with it, again each minute while it lasts; and faults
/// that were over before anybody looked, in a bounded number of lines. One thread.
class CameraLog {
 public:
  using Clock = std::chrono::steady_clock;

  struct Line {
    spdlog::level::level_enum level = spdlog::level::info;
    std::string text;
    bool operator==(const Line&) const = default;
  };

  /// `name`: what each line begins with, such as "left camera".
  explicit CameraLog(std::string name) : name_(std::move(name)) {}

  /// For each look: the lines to log now. Pure, for tests; `note` logs them.
  std::vector<Line> due(const CameraHealth& health, Clock::time_point now);
  void note(const CameraHealth& health);

 private:
  void tellState(const CameraHealth& health, bool changed, Clock::time_point now, std::vector<Line>& lines);
  void tellUnseen(const CameraHealth& health, Clock::time_point now, std::vector<Line>& lines);

  std::string name_;
  std::optional<CameraState> state_;  ///< at the last look
  std::uint64_t reconnections_ = 0;   ///< likewise
  std::uint64_t untold_ = 0;          ///< reconnections that no line tells of
  RepeatedWarnings lasting_;
  LineBudget budget_;
};

}  // namespace cartvo
