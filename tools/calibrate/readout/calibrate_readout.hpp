#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo calibrate readout`.
void addCalibrateReadout(CLI::App& calibrate);

}  // namespace cartvo
