#pragma once

namespace cartvo {

class Command;

/// Adds `discover` to `cartvo camera`.
void addDiscoverAction(Command camera);

}  // namespace cartvo
