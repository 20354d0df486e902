#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo calibrate board`.
void addCalibrateBoard(CLI::App& calibrate);

}  // namespace cartvo
