#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo calibrate convert`.
void addCalibrateConvert(CLI::App& calibrate);

}  // namespace cartvo
