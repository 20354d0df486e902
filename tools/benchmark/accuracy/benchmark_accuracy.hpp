#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo benchmark accuracy`.
void addAccuracyBenchmark(CLI::App& benchmark);

}  // namespace cartvo
