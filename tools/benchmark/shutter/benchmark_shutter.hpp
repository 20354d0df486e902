#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo benchmark shutter`.
void addShutterBenchmark(Command benchmark);

}  // namespace cartvo
