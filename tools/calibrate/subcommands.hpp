#pragma once

namespace cartvo {

class Command;

/// Adds the arguments and the callback of `cartvo calibrate SOURCE`, which runs if no subcommand is given.
void addCalibrateRig(Command calibrate);

// Each adds the subcommand of `cartvo calibrate` that its name says.
void addCalibrateBoard(Command calibrate);
void addCalibrateCheck(Command calibrate);
void addCalibrateConvert(Command calibrate);
void addCalibrateMask(Command calibrate);
void addCalibrateMount(Command calibrate);
void addCalibratePlan(Command calibrate);
void addCalibrateReadout(Command calibrate);

}  // namespace cartvo
