#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo benchmark accuracy`.
void addAccuracyBenchmark(CLI::App& benchmark);

}  // namespace cartvo
