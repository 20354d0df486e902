#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo benchmark robustness`.
void addRobustnessBenchmark(CLI::App& benchmark);

}  // namespace cartvo
