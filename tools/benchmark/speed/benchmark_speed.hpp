#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo benchmark speed`.
void addSpeedBenchmark(Command benchmark);

}  // namespace cartvo
