#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo calibrate check`.
void addCalibrateCheck(Command calibrate);

}  // namespace cartvo
