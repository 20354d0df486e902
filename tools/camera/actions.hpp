#pragma once

namespace cartvo {

class Command;

// Each adds the action of `cartvo camera` that its name says.
void addDiscoverAction(Command camera);
void addNetworkAction(Command camera);

}  // namespace cartvo
