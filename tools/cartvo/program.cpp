// The command line of `cartvo`, for each of its programs.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "common/command_line/bash_completion.hpp"
#include "common/command_line/command_line.hpp"
#include "common/command_line/parser.hpp"
#include "common/command_line/standard_output.hpp"
#include "common/printable_text.hpp"
#include "tools/cartvo/commands.hpp"

namespace cartvo {
namespace {

/// Prints an error, line by line. It may quote files and their names: what is not printable is escaped.
void printError(const std::string& message) {
  constexpr std::size_t kMaxLineBytes = 4000;
  std::istringstream lines(message);
  std::string prefix = "cartvo: ";
  for (std::string line; std::getline(lines, line); prefix.clear())
    std::fprintf(stderr, "%s%s\n", prefix.c_str(), printableExcerpt(line, kMaxLineBytes).c_str());
}

constexpr int kWrongCommandLine = 2;

/// Runs the command; returns the exit code.
int run(Program& program, const std::vector<std::string>& arguments) {
  if (!arguments.empty() && arguments.front() == "benchmark") {
    std::fputs("cartvo: the benchmarks are in lab/ of the source: lab/lab accuracy --help\n", stderr);
    return kWrongCommandLine;
  }
  try {
    if (const std::string unknown = unknownWord(program.command(), arguments); !unknown.empty()) {
      std::fprintf(stderr, "cartvo: %s\n", unknown.c_str());
      return kWrongCommandLine;
    }
    program.parse(arguments);
  } catch (const ExitCode& end) {
    return end.code();
  } catch (const CommandLineError& error) {
    std::fputs(commandLineError(program.command(), error).c_str(), stderr);
    return kWrongCommandLine;
  } catch (const std::filesystem::filesystem_error& error) {
    printError(textOf(error));
    return EXIT_FAILURE;
  } catch (const std::exception& error) {
    printError(error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}

}  // namespace

Command addNamedCommand(Command cartvo, const std::string& name) {
  const CommandText* text = std::find_if(std::begin(kCommands), std::end(kCommands),
                                         [&](const CommandText& command) { return command.name == name; });
  return cartvo.addSubcommand(name, text->description);
}

int runProgram(const std::vector<std::string>& arguments) {
  occupyStandardDescriptors();
  Program program("cartvo", "cartvo: motion from two ordinary IP cameras");
  const Command command = program.command();
  command.addVersionFlag("-V,--version", "cartvo " CARTVO_VERSION);
  command.limitSubcommands(1, 1);
  command.footer("'cartvo COMMAND --help' or 'cartvo help COMMAND' explains each command.");
  addCommands(command);
  refuseUnusableValues(command);
  const std::vector<Command> commands = command.subcommands();
  addBashCompletionFlag(command, "cartvo", commands.size() == 1 ? commands.front().name() : "");

  const int code = run(program, arguments);
  const std::string error = standardOutputError();
  if (!error.empty()) std::fprintf(stderr, "cartvo: %s\n", error.c_str());
  return code == EXIT_SUCCESS && !error.empty() ? EXIT_FAILURE : code;
}

}  // namespace cartvo
