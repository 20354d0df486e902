#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo calibrate mount`.
void addCalibrateMount(CLI::App& calibrate);

}  // namespace cartvo
