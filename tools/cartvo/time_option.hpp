#pragma once

#include "common/command_line/parser.hpp"

namespace cartvo {

/// Reads the value of an option as a time, not negative: seconds, M:SS or H:MM:SS, with decimals. For
/// Option::transform() of an option of type double, s.
Option::Transformation timeInSeconds();

/// As timeInSeconds, for times longer than 0.
Option::Transformation positiveTimeInSeconds();

}  // namespace cartvo
