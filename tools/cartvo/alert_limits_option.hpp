#pragma once

#include <optional>

#include "daemon/pipeline/protection_level.hpp"

namespace cartvo {

class Command;

/// Adds --alert-limits of a command that replays. `limits` must outlive the command.
void addAlertLimitsOption(Command command, std::optional<daemon::AlertLimits>& limits);

/// Adds --alert-limits of a report that counts VALID messages above them. `limits` must outlive the command.
void addAlertLimitsOption(Command command, daemon::AlertLimits& limits);

}  // namespace cartvo
