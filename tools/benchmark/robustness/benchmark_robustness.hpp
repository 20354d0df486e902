#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo benchmark robustness`.
void addRobustnessBenchmark(Command benchmark);

}  // namespace cartvo
