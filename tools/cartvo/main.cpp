// `cartvo`: the command line tools around the daemon, one subcommand each.
// Exit codes: 0 success, 1 failure, 2 wrong command line.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "common/command_line/bash_completion.hpp"
#include "common/command_line/command_line.hpp"
#include "common/command_line/parser.hpp"
#include "common/command_line/standard_output.hpp"
#include "common/files/file_system_error.hpp"
#include "common/printable_text.hpp"
#include "tools/cartvo/commands.hpp"

namespace {

/// Prints an error, line by line. It may quote files and their names: what is not printable is escaped.
void printError(const std::string& message) {
  constexpr std::size_t kMaxLineBytes = 4000;
  std::istringstream lines(message);
  std::string prefix = "cartvo: ";
  for (std::string line; std::getline(lines, line); prefix.clear())
    std::fprintf(stderr, "%s%s\n", prefix.c_str(), cartvo::printableExcerpt(line, kMaxLineBytes).c_str());
}

constexpr int kWrongCommandLine = 2;

void addCommands(cartvo::Command command) {
  cartvo::addSimulateCommand(command);
  cartvo::addReplayCommand(command);
  cartvo::addExportCommand(command);
  cartvo::addRecordingCommand(command);
  cartvo::addEvaluateCommand(command);
  cartvo::addWatchCommand(command);
  cartvo::addCameraCommand(command);
  cartvo::addDoctorCommand(command);
  cartvo::addCalibrateCommand(command);
  cartvo::refuseUnusableValues(command);
}

/// Runs the command; returns the exit code.
int run(cartvo::Program& program, const std::vector<std::string>& arguments) {
  if (!arguments.empty() && arguments.front() == "benchmark") {
    std::fputs("cartvo: the benchmarks are in lab/ of the source: lab/lab accuracy --help\n", stderr);
    return kWrongCommandLine;
  }
  try {
    if (const std::string unknown = cartvo::unknownWord(program.command(), arguments); !unknown.empty()) {
      std::fprintf(stderr, "cartvo: %s\n", unknown.c_str());
      return kWrongCommandLine;
    }
    program.parse(arguments);
  } catch (const cartvo::ExitCode& end) {
    return end.code();
  } catch (const cartvo::CommandLineError& error) {
    std::fputs(cartvo::commandLineError(program.command(), error).c_str(), stderr);
    return kWrongCommandLine;
  } catch (const std::filesystem::filesystem_error& error) {
    printError(cartvo::textOf(error));
    return EXIT_FAILURE;
  } catch (const std::exception& error) {
    printError(error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): running out of memory during start-up may end the program
int main(int argument_count, char** arguments) {
  cartvo::occupyStandardDescriptors();
  cartvo::Program program("cartvo", "cartvo: motion from two ordinary IP cameras");
  const cartvo::Command command = program.command();
  command.addVersionFlag("-V,--version", "cartvo " CARTVO_VERSION);
  command.limitSubcommands(1, 1);
  command.footer("'cartvo COMMAND --help' or 'cartvo help COMMAND' explains each command.");
  addCommands(command);
  cartvo::addBashCompletionFlag(command, "cartvo");

  const int code =
      run(program,
          cartvo::withHelpAsOption({arguments + std::min(1, argument_count), arguments + argument_count}));
  const std::string error = cartvo::standardOutputError();
  if (!error.empty()) std::fprintf(stderr, "cartvo: %s\n", error.c_str());
  return code == EXIT_SUCCESS && !error.empty() ? EXIT_FAILURE : code;
}
