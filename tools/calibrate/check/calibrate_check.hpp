#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo calibrate check`.
void addCalibrateCheck(CLI::App& calibrate);

}  // namespace cartvo
