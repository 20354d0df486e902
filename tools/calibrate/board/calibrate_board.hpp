#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo calibrate board`.
void addCalibrateBoard(CLI::App& calibrate);

}  // namespace cartvo
