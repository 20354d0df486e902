#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `network` to `cartvo camera`.
void addNetworkAction(CLI::App& camera);

}  // namespace cartvo
