#pragma once

#include <CLI/CLI.hpp>

namespace cartvo {

// Each adds one subcommand to `cartvo`; its callback does the work and throws what goes wrong.
// A command that must end with another exit code than 0 or 1 throws CLI::RuntimeError.
void addSimulateCommand(CLI::App& cartvo);
void addReplayCommand(CLI::App& cartvo);
void addRecordingCommand(CLI::App& cartvo);
void addEvaluateCommand(CLI::App& cartvo);
void addWatchCommand(CLI::App& cartvo);
void addCalibrateCommand(CLI::App& cartvo);
void addBenchmarkCommand(CLI::App& cartvo);

}  // namespace cartvo
