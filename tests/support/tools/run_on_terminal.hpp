#pragma once

#include <stdexcept>
#include <string>

#include <pty.h>
#include <unistd.h>

#include "support/places.hpp"
#include "support/tools/child_process.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo::test {

/// Runs the built `cartvo` with a terminal of 100 columns as its input, output and error output, and captures
/// what it writes there.
inline CommandResult runOnTerminal(const std::string& arguments) {
  const std::string command = "exec " + cartvoProgram().string() + " " + arguments;
  winsize size{};
  size.ws_row = 30;
  size.ws_col = 100;
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child < 0) throw std::runtime_error("cannot open a terminal for cartvo");
  if (child == 0) becomeShell(command);
  const std::string output = readToEnd(terminal);
  const int exit_code = awaitExit(child);
  close(terminal);
  return {exit_code, output};
}

}  // namespace cartvo::test
