#pragma once

namespace cartvo {

class Command;

/// Adds the arguments and the callback of `cartvo calibrate SOURCE`, which runs if no subcommand is given.
void addCalibrateRig(Command calibrate);

}  // namespace cartvo
