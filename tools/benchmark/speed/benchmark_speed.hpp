#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo benchmark speed`.
void addSpeedBenchmark(CLI::App& benchmark);

}  // namespace cartvo
