#pragma once

#include <string>
#include <vector>

#include "common/command_line/parser.hpp"

namespace cartvo {

/// A command of `cartvo`: a program of its own, cartvo-NAME, which parses the whole command line of `cartvo`.
struct CommandText {
  const char* name;
  const char* description;
};

/// In the order of `cartvo --help`.
inline constexpr CommandText kCommands[] = {
    {"simulate", "Serve two simulated IP cameras, with ground truth"},
    {"replay", "Estimate the motion from a recording or a folder of images"},
    {"export", "Write a recording or results in the formats of other tools"},
    {"recording", "Show, verify or trim a recording"},
    {"evaluate", "Compare a trajectory with the truth"},
    {"watch", "Show the odometry of cartvod live, with a summary at the end"},
    {"camera", "Find cameras; show, check and change settings of Hikvision cameras; set up their network"},
    {"doctor", "Look at everything that goes wrong in the field, and say what to do about it"},
    {"calibrate", "Calibrate the cameras, and related tools"},
};

/// Adds the subcommand `name` of kCommands, without options.
Command addNamedCommand(Command cartvo, const std::string& name);

/// Adds the commands of a program; each program defines it: cartvo-NAME adds NAME, `cartvo` all, without
/// options. A command's callback runs it and throws on failure; one with a special exit code throws ExitCode.
void addCommands(Command cartvo);

/// Parses `arguments`, which are without the program's name, by addCommands() and runs the command. Returns
/// the exit code: 0 success, 1 failure, 2 wrong command line.
int runProgram(const std::vector<std::string>& arguments);

}  // namespace cartvo
