#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo benchmark robustness`.
void addRobustnessBenchmark(CLI::App& benchmark);

}  // namespace cartvo
