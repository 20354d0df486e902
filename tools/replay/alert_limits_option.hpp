#pragma once

#include <optional>

#include "common/command_line/cli11_forward.hpp"
#include "daemon/pipeline/protection_level.hpp"

namespace cartvo {

/// Adds --alert-limits, which sets `limits`; it must outlive the command.
void addAlertLimitsOption(CLI::App& command, std::optional<daemon::AlertLimits>& limits);

}  // namespace cartvo
