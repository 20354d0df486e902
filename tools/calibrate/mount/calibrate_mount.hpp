#pragma once

namespace cartvo {

class Command;

/// Adds `cartvo calibrate mount`.
void addCalibrateMount(Command calibrate);

}  // namespace cartvo
