// Changes of the odometry's validity, in a bounded number of lines.

#include "daemon/validity_log.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "daemon/odometry_reasons.hpp"

namespace cartvo {
namespace {

constexpr int kMostLinesAtOnce = 5;
constexpr std::chrono::seconds kLinePeriod{10};

std::string validityText(const odometry_t& message) {
  if (message.status == odometry_t::VALID) return "odometry is valid";
  return "odometry is not valid: " + reasonNames(message.reasons);
}

}  // namespace

/// A line comes free each period, up to as many as may follow one another at once.
bool ValidityLog::mayTell(Clock::time_point now) {
  const auto periods = (now - last_refill_) / kLinePeriod;
  lines_left_ = static_cast<int>(std::min<std::int64_t>(lines_left_ + periods, kMostLinesAtOnce));
  last_refill_ += periods * kLinePeriod;
  return lines_left_ > 0;
}

std::string ValidityLog::due(const odometry_t& message, Clock::time_point now) {
  const bool valid = message.status == odometry_t::VALID;
  if (!begun_) {
    lines_left_ = kMostLinesAtOnce;
    last_refill_ = last_told_ = now;
  }
  if (!begun_ || valid != valid_) ++untold_changes_;
  begun_ = true;
  valid_ = valid;
  if (untold_changes_ == 0 || !mayTell(now)) return {};

  std::string line = validityText(message);
  if (untold_changes_ > 1) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - last_told_).count();
    line += fmt::format("; that changed {} times in {} s", untold_changes_, seconds);
  }
  --lines_left_;
  untold_changes_ = 0;
  last_told_ = now;
  return line;
}

void ValidityLog::note(const odometry_t& message) {
  const std::string line = due(message, Clock::now());
  if (!line.empty()) spdlog::info(line);
}

}  // namespace cartvo
