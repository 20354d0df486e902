#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo calibrate readout`.
void addCalibrateReadout(CLI::App& calibrate);

}  // namespace cartvo
