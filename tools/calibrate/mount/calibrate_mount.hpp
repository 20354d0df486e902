#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo calibrate mount`.
void addCalibrateMount(CLI::App& calibrate);

}  // namespace cartvo
