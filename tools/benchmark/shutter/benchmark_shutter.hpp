#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `cartvo benchmark shutter`.
void addShutterBenchmark(CLI::App& benchmark);

}  // namespace cartvo
