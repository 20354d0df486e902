// Changes of the odometry's validity, in a bounded number of lines.

#include "daemon/validity_log.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "daemon/odometry_reasons.hpp"

namespace cartvo {
namespace {

std::string validityText(const odometry_t& message) {
  if (message.status == odometry_t::VALID) return "odometry is valid";
  return "odometry is not valid: " + reasonNames(message.reasons);
}

}  // namespace

std::string ValidityLog::due(const odometry_t& message, Clock::time_point now) {
  const bool valid = message.status == odometry_t::VALID;
  if (!begun_) last_told_ = now;
  if (!begun_ || valid != valid_) ++untold_changes_;
  begun_ = true;
  valid_ = valid;
  if (!budget_.allows(now) || untold_changes_ == 0) return {};

  std::string line = validityText(message);
  if (untold_changes_ > 1) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - last_told_).count();
    line += fmt::format("; that changed {} times in {} s", untold_changes_, seconds);
  }
  budget_.spend();
  untold_changes_ = 0;
  last_told_ = now;
  return line;
}

void ValidityLog::note(const odometry_t& message) {
  const std::string line = due(message, Clock::now());
  if (!line.empty()) spdlog::info(line);
}

}  // namespace cartvo
