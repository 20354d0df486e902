#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo calibrate convert`.
void addCalibrateConvert(Command calibrate);

}  // namespace cartvo
