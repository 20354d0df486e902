#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `discover` to `cartvo camera`.
void addDiscoverAction(CLI::App& camera);

}  // namespace cartvo
