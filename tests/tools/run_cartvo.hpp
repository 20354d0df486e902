#pragma once

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

#include "support/places.hpp"

namespace cartvo::test {

struct Finished {
  int exit_code = -1;
  std::string said;
};

/// Runs a command as people do, through the shell.
inline Finished runCommand(const std::string& command) {
  Finished run;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return run;
  std::array<char, 4096> part{};
  for (std::size_t count = 0; (count = fread(part.data(), 1, part.size(), pipe)) > 0;)
    run.said.append(part.data(), count);
  const int status = pclose(pipe);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

/// Runs the built `cartvo`, and hears both its outputs.
inline Finished runCartvo(const std::string& arguments) {
  return runCommand(cartvoProgram().string() + " " + arguments + " 2>&1");
}

/// The same for programs, which read its standard output: how far it has come is told on the other.
inline Finished pipeCartvo(const std::string& arguments) {
  return runCommand(cartvoProgram().string() + " " + arguments + " 2>/dev/null");
}

}  // namespace cartvo::test
