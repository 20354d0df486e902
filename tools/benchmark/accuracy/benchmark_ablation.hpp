#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo benchmark ablation`.
void addAblationBenchmark(CLI::App& benchmark);

}  // namespace cartvo
