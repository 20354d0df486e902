#pragma once

#include <optional>

#include "common/command_line/cli11_forward.hpp"
#include "daemon/pipeline/protection_level.hpp"

namespace cartvo {

/// Adds --alert-limits of a command that replays. `limits` must outlive the command.
void addAlertLimitsOption(CLI::App& command, std::optional<daemon::AlertLimits>& limits);

/// Adds --alert-limits of a report that counts VALID messages above them. `limits` must outlive the command.
void addAlertLimitsOption(CLI::App& command, daemon::AlertLimits& limits);

}  // namespace cartvo
