#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

/// Adds `discover` to `cartvo camera`.
void addDiscoverAction(CLI::App& camera);

}  // namespace cartvo
