#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo calibrate convert`.
void addCalibrateConvert(CLI::App& calibrate);

}  // namespace cartvo
