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

#include <CLI/CLI.hpp>

#include "common/command_line/bash_completion.hpp"
#include "common/command_line/standard_output.hpp"
#include "common/files/file_system_error.hpp"
#include "common/printable_text.hpp"
#include "tools/cartvo/command_line.hpp"
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

void addCommands(CLI::App& cartvo) {
  cartvo::addSimulateCommand(cartvo);
  cartvo::addReplayCommand(cartvo);
  cartvo::addExportCommand(cartvo);
  cartvo::addRecordingCommand(cartvo);
  cartvo::addEvaluateCommand(cartvo);
  cartvo::addWatchCommand(cartvo);
  cartvo::addCameraCommand(cartvo);
  cartvo::addDoctorCommand(cartvo);
  cartvo::addCalibrateCommand(cartvo);
  cartvo::addBenchmarkCommand(cartvo);
  cartvo::refuseUnusableValues(cartvo);
}

/// Runs the command; returns the exit code.
int run(CLI::App& cartvo, std::vector<std::string> arguments) {
  try {
    if (const std::string unknown = cartvo::unknownWord(cartvo, arguments); !unknown.empty()) {
      std::fprintf(stderr, "cartvo: %s\n", unknown.c_str());
      return kWrongCommandLine;
    }
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the end
    cartvo.parse(std::move(arguments));
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return cartvo.exit(error) == 0 ? EXIT_SUCCESS : kWrongCommandLine;
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
  CLI::App cartvo{"cartvo: motion from two ordinary IP cameras", "cartvo"};
  cartvo.set_version_flag("-V,--version", "cartvo " CARTVO_VERSION);
  cartvo.require_subcommand(1);
  cartvo.failure_message(cartvo::commandLineError);
  cartvo.footer("'cartvo COMMAND --help' or 'cartvo help COMMAND' explains each command.");
  addCommands(cartvo);
  cartvo::addBashCompletionFlag(cartvo, "cartvo");

  const int code =
      run(cartvo,
          cartvo::withHelpAsOption({arguments + std::min(1, argument_count), arguments + argument_count}));
  const std::string error = cartvo::standardOutputError();
  if (!error.empty()) std::fprintf(stderr, "cartvo: %s\n", error.c_str());
  return code == EXIT_SUCCESS && !error.empty() ? EXIT_FAILURE : code;
}
