#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo calibrate check`.
void addCalibrateCheck(CLI::App& calibrate);

}  // namespace cartvo
