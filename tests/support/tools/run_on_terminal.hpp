#pragma once

#include <array>
#include <stdexcept>
#include <string>

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/places.hpp"
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
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  CommandResult run;
  std::array<char, 4096> part{};
  // Reading fails when the program has closed the terminal.
  for (ssize_t count = 0; (count = read(terminal, part.data(), part.size())) > 0;)
    run.output.append(part.data(), static_cast<std::size_t>(count));
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

}  // namespace cartvo::test
