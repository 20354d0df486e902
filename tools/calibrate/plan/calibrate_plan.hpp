#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo calibrate plan`.
void addCalibratePlan(CLI::App& calibrate);

}  // namespace cartvo
