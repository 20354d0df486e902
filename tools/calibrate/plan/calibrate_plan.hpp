#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo calibrate plan`.
void addCalibratePlan(CLI::App& calibrate);

}  // namespace cartvo
