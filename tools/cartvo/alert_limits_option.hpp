#pragma once

#include <optional>

#include "pipeline/protection_level.hpp"

namespace cartvo {

class Command;

/// Adds --alert-limits of a command that replays. `limits` must outlive the command.
void addAlertLimitsOption(Command command, std::optional<pipeline::AlertLimits>& limits);

/// Adds --alert-limits of a report that counts VALID messages above them. `limits` must outlive the command.
void addAlertLimitsOption(Command command, pipeline::AlertLimits& limits);

}  // namespace cartvo
