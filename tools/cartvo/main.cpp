// `cartvo`: the command line tools around the daemon. Becomes the program of the command that it is given.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <unistd.h>

#include "common/command_line/command_line.hpp"
#include "tools/cartvo/commands.hpp"

namespace cartvo {
namespace {

using Words = std::vector<std::string>;

/// The name of the command in the arguments, which only flags may precede; empty: none that exists.
std::string commandIn(const Words& arguments) {
  const auto word = std::find_if(arguments.begin(), arguments.end(),
                                 [](const auto& text) { return !text.starts_with('-'); });
  const auto is_named = [&](const CommandText& command) { return *word == command.name; };
  return word != arguments.end() && std::any_of(std::begin(kCommands), std::end(kCommands), is_named) ? *word
                                                                                                      : "";
}

/// Replaces this process by the program of a command, in ../libexec/cartvo from the folder of this program
/// when installed and in the build folder. Returns the exit code if it cannot be started.
int become(const std::string& command, char** arguments) {
  std::error_code no_error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", no_error);
  const std::filesystem::path file =
      program.parent_path().parent_path() / "libexec/cartvo" / ("cartvo-" + command);
  execv(file.c_str(), arguments);
  std::fprintf(stderr,
               "cartvo: the program of 'cartvo %s' cannot be started: %s: %s (tools/build builds all)\n",
               command.c_str(), file.c_str(), std::system_category().message(errno).c_str());
  return EXIT_FAILURE;
}

}  // namespace

void addCommands(Command cartvo) {
  for (const CommandText& command : kCommands)
    addNamedCommand(cartvo, command.name);
}

}  // namespace cartvo

// NOLINTNEXTLINE(bugprone-exception-escape): running out of memory during start-up may end the program
int main(int argument_count, char** arguments) {
  const std::vector<std::string> words =
      cartvo::withHelpAsOption({arguments + std::min(1, argument_count), arguments + argument_count});
  const std::string command = cartvo::commandIn(words);
  return command.empty() ? cartvo::runProgram(words) : cartvo::become(command, arguments);
}
