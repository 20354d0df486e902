#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo benchmark accuracy`.
void addAccuracyBenchmark(CLI::App& benchmark);

}  // namespace cartvo
