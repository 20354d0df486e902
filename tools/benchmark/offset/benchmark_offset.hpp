#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo benchmark offset`.
void addOffsetBenchmark(CLI::App& benchmark);

}  // namespace cartvo
