#pragma once

#include <array>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace cartvo::test {

/// Runs the command of a shell in place of this process, a forked one.
[[noreturn]] inline void becomeShell(const std::string& command) {
  execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
  _exit(127);
}

/// Reads to the end; also reading from a terminal that its program has closed ends it.
inline std::string readToEnd(int descriptor) {
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t count = 0; (count = read(descriptor, part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<std::size_t>(count));
  return text;
}

/// Exit code by the status of waitpid() or pclose(); -1 if the process did not exit by itself.
inline int exitCodeOf(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Waits for the end of a child; exitCodeOf() it.
inline int awaitExit(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return exitCodeOf(status);
}

}  // namespace cartvo::test
