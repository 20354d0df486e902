#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo calibrate board`.
void addCalibrateBoard(CLI::App& calibrate);

}  // namespace cartvo
