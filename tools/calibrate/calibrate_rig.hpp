#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds the arguments and the callback of `cartvo calibrate SOURCE`, which runs if no subcommand is given.
void addCalibrateRig(CLI::App& calibrate);

}  // namespace cartvo
