#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo calibrate convert`.
void addCalibrateConvert(CLI::App& calibrate);

}  // namespace cartvo
