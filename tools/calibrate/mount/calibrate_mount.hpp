#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo calibrate mount`.
void addCalibrateMount(CLI::App& calibrate);

}  // namespace cartvo
