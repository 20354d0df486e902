#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo calibrate readout`.
void addCalibrateReadout(Command calibrate);

}  // namespace cartvo
