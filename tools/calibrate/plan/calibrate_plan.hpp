#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo calibrate plan`.
void addCalibratePlan(Command calibrate);

}  // namespace cartvo
