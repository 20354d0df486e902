#pragma once

#include <string>
#include <vector>

#include "common/command_line/command_line_error.hpp"

namespace cartvo {

class Command;

/// The command line `cartvo help [COMMAND...]` as `cartvo [COMMAND...] --help`; any other one unchanged.
std::vector<std::string> withHelpAsOption(std::vector<std::string> arguments);

/// Names the first command or option that does not exist, with the nearest one that does, or with all
/// commands. Empty if all exist. Program::parse() would first complain of what is missing, such as a required
/// option.
/// `arguments`: without the program's name.
std::string unknownWord(Command cartvo, const std::vector<std::string>& arguments);

/// Adds to all options of a command and its subcommands that a value is neither empty nor NaN, which no range
/// excludes.
void refuseUnusableValues(Command command);

/// The error message of a wrong command line: "PROGRAM: REASON", and the command whose --help explains it.
std::string commandLineError(Command cartvo, const CommandLineError& error);

}  // namespace cartvo
