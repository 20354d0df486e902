#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo benchmark robustness`.
void addRobustnessBenchmark(CLI::App& benchmark);

}  // namespace cartvo
