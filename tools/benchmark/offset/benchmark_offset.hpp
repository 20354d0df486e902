#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo benchmark offset`.
void addOffsetBenchmark(CLI::App& benchmark);

}  // namespace cartvo
