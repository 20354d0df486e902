// Completion of a program's command line in bash, derived from its commands and options.
#pragma once

#include <string>

namespace cartvo {

class Command;

/// A bash script that completes the commands, options and values of `program`, which is called `name`. What
/// is hidden in --help is left out. Values are completed by the kind that --help shows: a choice ({a,b}),
/// FILE or PATH, DIR. `part`: empty, or the one command that `program` has of the commands of `name`: then
/// the script is a function for that command, which the script of `name` uses.
std::string bashCompletion(Command program, const std::string& name, const std::string& part);

/// Adds the hidden flag --bash-completion, which prints bashCompletion() and ends the program with success.
/// Call it after all commands and options have been added, on the program itself.
void addBashCompletionFlag(Command program, const std::string& name, const std::string& part);

}  // namespace cartvo
