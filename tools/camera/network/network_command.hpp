#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `network` to `cartvo camera`.
void addNetworkAction(CLI::App& camera);

}  // namespace cartvo
