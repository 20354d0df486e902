#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds `cartvo calibrate readout`.
void addCalibrateReadout(CLI::App& calibrate);

}  // namespace cartvo
