#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo benchmark speed`.
void addSpeedBenchmark(CLI::App& benchmark);

}  // namespace cartvo
