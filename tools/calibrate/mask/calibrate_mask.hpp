#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo calibrate mask`.
void addCalibrateMask(CLI::App& calibrate);

}  // namespace cartvo
