#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "support/places.hpp"
#include "support/tools/child_process.hpp"

namespace cartvo::test {

/// Exit code and output of a finished command.
struct CommandResult {
  int exit_code = -1;  ///< -1 if the command did not exit by itself
  std::string output;
};

/// Runs a command through the shell and captures its standard output.
inline CommandResult runCommand(const std::string& command) {
  CommandResult run;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return run;
  std::array<char, 4096> part{};
  for (std::size_t count = 0; (count = fread(part.data(), 1, part.size(), pipe)) > 0;)
    run.output.append(part.data(), count);
  run.exit_code = exitCodeOf(pclose(pipe));
  return run;
}

/// Runs the built `cartvo` and captures its standard and error output.
inline CommandResult runCartvo(const std::string& arguments) {
  return runCommand(cartvoProgram().string() + " " + arguments + " 2>&1");
}

/// As `runCartvo`, with each line of the progress.
inline CommandResult runWithAllProgress(const std::string& arguments) {
  return runCommand("CARTVO_PROGRESS_INTERVAL=0 " + cartvoProgram().string() + " " + arguments + " 2>&1");
}

/// Runs the built `cartvo` and captures only its standard output, without the progress on the error output.
inline CommandResult pipeCartvo(const std::string& arguments) {
  return runCommand(cartvoProgram().string() + " " + arguments + " 2>/dev/null");
}

/// Runs a command in a network namespace with loopback only.
inline CommandResult runIsolated(const std::string& command) {
  const std::string isolated = (sourceFolder() / "tools/in_network_namespace").string();
  return runCommand(isolated + " sh -c '" + command + "' 2>&1");
}

}  // namespace cartvo::test
