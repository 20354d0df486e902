#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo benchmark offset`.
void addOffsetBenchmark(CLI::App& benchmark);

}  // namespace cartvo
