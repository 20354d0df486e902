#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo benchmark ablation`.
void addAblationBenchmark(Command benchmark);

}  // namespace cartvo
