#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Reads the value of an option as a time, not negative: seconds, M:SS or H:MM:SS, with decimals. For
/// CLI::Option::transform of an option of type double, s.
CLI::Validator timeInSeconds();

/// As timeInSeconds, for times longer than 0.
CLI::Validator positiveTimeInSeconds();

}  // namespace cartvo
