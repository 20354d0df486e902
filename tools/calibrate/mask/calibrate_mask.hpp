#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo calibrate mask`.
void addCalibrateMask(Command calibrate);

}  // namespace cartvo
