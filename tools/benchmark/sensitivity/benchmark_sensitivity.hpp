#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `cartvo benchmark sensitivity`.
void addSensitivityBenchmark(CLI::App& benchmark);

}  // namespace cartvo
