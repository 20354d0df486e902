#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo calibrate check`.
void addCalibrateCheck(CLI::App& calibrate);

}  // namespace cartvo
