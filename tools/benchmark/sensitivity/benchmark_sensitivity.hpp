#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo benchmark sensitivity`.
void addSensitivityBenchmark(CLI::App& benchmark);

}  // namespace cartvo
