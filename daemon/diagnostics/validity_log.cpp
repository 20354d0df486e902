// Log lines about changes of the odometry's validity, limited in number.

#include "daemon/diagnostics/validity_log.hpp"

#include <cmath>

#include <fmt/format.h>

#include "daemon/diagnostics/journal.hpp"
#include "daemon/publish/message_names.hpp"

namespace cartvo::daemon {
namespace {

std::string validityText(const odometry_t& message, const std::string& bound_exceeded) {
  if (message.status == odometry_t::VALID) return "odometry is valid";
  std::string text = "odometry is not valid: " + reasonNames(message.reasons);
  if ((message.reasons & odometry_t::REASON_OFFSET_TOO_LARGE) != 0)
    text += fmt::format(
        " (the right image is exposed {:.1f} ms {} the left one; odometry.maximum_offset allows less)",
        1e-3 * std::abs(static_cast<double>(message.offset_us)), message.offset_us > 0 ? "after" : "before");
  if (!bound_exceeded.empty()) text += " (" + bound_exceeded + ")";
  return text;
}

}  // namespace

std::string ValidityLog::due(const odometry_t& message, const std::string& bound_exceeded,
                             Clock::time_point now) {
  const bool valid = message.status == odometry_t::VALID;
  if (!begun_) last_logged_ = now;
  if (!begun_ || valid != valid_) ++unlogged_changes_;
  begun_ = true;
  valid_ = valid;
  if (!budget_.allows(now) || unlogged_changes_ == 0) return {};

  std::string line = validityText(message, bound_exceeded);
  if (unlogged_changes_ > 1) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - last_logged_).count();
    line += fmt::format("; its validity changed {} times in {} s", unlogged_changes_, seconds);
  }
  budget_.spend();
  unlogged_changes_ = 0;
  last_logged_ = now;
  return line;
}

void ValidityLog::log(const odometry_t& message, const std::string& bound_exceeded) {
  const std::string line = due(message, bound_exceeded, Clock::now());
  if (line.empty()) return;
  logEvent(spdlog::level::info, line,
           {{"CARTVO_EVENT", "odometry_validity"},
            {"CARTVO_ODOMETRY_STATUS", message.status == odometry_t::VALID ? "valid" : "invalid"},
            {"CARTVO_REASONS", reasonNames(message.reasons)}});
}

}  // namespace cartvo::daemon
