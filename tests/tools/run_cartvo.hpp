#pragma once

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

#include "support/places.hpp"

namespace cartvo::test {

struct Finished {
  int exit_code = -1;
  std::string said;  ///< on both outputs
};

/// Runs the built `cartvo` as people do, through the shell.
inline Finished runCartvo(const std::string& arguments) {
  const std::string command = cartvoProgram().string() + " " + arguments + " 2>&1";
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

}  // namespace cartvo::test
