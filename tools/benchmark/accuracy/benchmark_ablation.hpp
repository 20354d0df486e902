#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo benchmark ablation`.
void addAblationBenchmark(CLI::App& benchmark);

}  // namespace cartvo
