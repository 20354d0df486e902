#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `network` to `cartvo camera`.
void addNetworkAction(CLI::App& camera);

}  // namespace cartvo
