#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo benchmark sensitivity`.
void addSensitivityBenchmark(Command benchmark);

}  // namespace cartvo
