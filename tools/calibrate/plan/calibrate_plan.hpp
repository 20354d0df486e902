#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo calibrate plan`.
void addCalibratePlan(CLI::App& calibrate);

}  // namespace cartvo
