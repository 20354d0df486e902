#pragma once

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

// Each function adds one subcommand to `cartvo`. Its callback runs the command and throws on failure; a
// command with a special exit code throws CLI::RuntimeError.
void addSimulateCommand(CLI::App& cartvo);
void addReplayCommand(CLI::App& cartvo);
void addExportCommand(CLI::App& cartvo);
void addRecordingCommand(CLI::App& cartvo);
void addEvaluateCommand(CLI::App& cartvo);
void addWatchCommand(CLI::App& cartvo);
void addCameraCommand(CLI::App& cartvo);
void addDoctorCommand(CLI::App& cartvo);
void addCalibrateCommand(CLI::App& cartvo);
void addBenchmarkCommand(CLI::App& cartvo);

}  // namespace cartvo
