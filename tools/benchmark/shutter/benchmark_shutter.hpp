#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo benchmark shutter`.
void addShutterBenchmark(CLI::App& benchmark);

}  // namespace cartvo
