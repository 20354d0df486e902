#pragma once

namespace cartvo {

class Command;

/// Adds `network` to `cartvo camera`.
void addNetworkAction(Command camera);

}  // namespace cartvo
