// The main function of the program of a command.
#include <algorithm>

#include "common/command_line/command_line.hpp"
#include "tools/cartvo/commands.hpp"

// NOLINTNEXTLINE(bugprone-exception-escape): running out of memory during start-up may end the program
int main(int argument_count, char** arguments) {
  return cartvo::runProgram(
      cartvo::withHelpAsOption({arguments + std::min(1, argument_count), arguments + argument_count}));
}
