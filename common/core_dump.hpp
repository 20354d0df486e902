#pragma once

namespace cartvo {

/// From now on this process writes no core dump, and only root can read its memory, also by a debugger.
/// Called before a secret is read into memory.
void disableCoreDumps();

}  // namespace cartvo
