#pragma once

#include "common/command_line/cli11_forward.hpp"
#include "daemon/pipeline/protection_level.hpp"

namespace cartvo {

/// Adds --alert-limits of reports that count VALID messages above them. `limits` must outlive the command.
CLI::Option* addAlertLimitsOption(CLI::App& command, daemon::AlertLimits& limits);

}  // namespace cartvo
