#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds what `cartvo calibrate SOURCE` takes, and what it does if none of its subcommands is given.
void addCalibrateRig(CLI::App& calibrate);

}  // namespace cartvo
