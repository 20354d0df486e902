#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo benchmark shutter`.
void addShutterBenchmark(CLI::App& benchmark);

}  // namespace cartvo
