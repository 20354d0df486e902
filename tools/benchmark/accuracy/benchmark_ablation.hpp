#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo benchmark ablation`.
void addAblationBenchmark(CLI::App& benchmark);

}  // namespace cartvo
