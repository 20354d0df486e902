#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo benchmark accuracy`.
void addAccuracyBenchmark(Command benchmark);

}  // namespace cartvo
