#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo calibrate board`.
void addCalibrateBoard(Command calibrate);

}  // namespace cartvo
