#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `discover` to `cartvo camera`.
void addDiscoverAction(CLI::App& camera);

}  // namespace cartvo
