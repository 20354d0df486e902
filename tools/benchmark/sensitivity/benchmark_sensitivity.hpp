#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo benchmark sensitivity`.
void addSensitivityBenchmark(CLI::App& benchmark);

}  // namespace cartvo
