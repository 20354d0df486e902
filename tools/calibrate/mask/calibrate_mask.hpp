#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo calibrate mask`.
void addCalibrateMask(CLI::App& calibrate);

}  // namespace cartvo
