#pragma once

namespace cartvo {

class Command;

// Each function adds one subcommand to `cartvo`. Its callback runs the command and throws on failure; a
// command with a special exit code throws ExitCode.
void addSimulateCommand(Command cartvo);
void addReplayCommand(Command cartvo);
void addExportCommand(Command cartvo);
void addRecordingCommand(Command cartvo);
void addEvaluateCommand(Command cartvo);
void addWatchCommand(Command cartvo);
void addCameraCommand(Command cartvo);
void addDoctorCommand(Command cartvo);
void addCalibrateCommand(Command cartvo);

}  // namespace cartvo
