#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo benchmark offset`.
void addOffsetBenchmark(Command benchmark);

}  // namespace cartvo
