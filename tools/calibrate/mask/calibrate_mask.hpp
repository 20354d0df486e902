#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo calibrate mask`.
void addCalibrateMask(CLI::App& calibrate);

}  // namespace cartvo
