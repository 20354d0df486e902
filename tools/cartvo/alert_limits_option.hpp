#pragma once

#include <optional>

#include "pipeline/protection_level.hpp"

namespace cartvo {

class Command;

/// Adds --alert-limits of a command that replays. `limits` must outlive the command.
void addAlertLimitsOption(Command command, std::optional<pipeline::AlertLimits>& limits);

}  // namespace cartvo
