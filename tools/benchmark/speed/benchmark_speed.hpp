#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo benchmark speed`.
void addSpeedBenchmark(CLI::App& benchmark);

}  // namespace cartvo
