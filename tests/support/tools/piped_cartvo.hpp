#pragma once

#include <array>
#include <csignal>
#include <stdexcept>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/places.hpp"
#include "support/tools/child_process.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo::test {

/// The built `cartvo`, whose error output is read line by line while it runs. It prints each line of its
/// progress, and cannot get far ahead of the reader: the pipe between them holds 4 kB. The destructor kills
/// it if it still runs.
class PipedCartvo {
 public:
  explicit PipedCartvo(const std::string& arguments) {
    const std::string command =
        "CARTVO_PROGRESS_INTERVAL=0 exec " + cartvoProgram().string() + " " + arguments + " >/dev/null";
    std::array<int, 2> pipe{};
    constexpr int kSmallest = 4096;  // bytes
    if (pipe2(pipe.data(), O_CLOEXEC) != 0 || fcntl(pipe[0], F_SETPIPE_SZ, kSmallest) != kSmallest ||
        (pid_ = fork()) < 0)
      throw std::runtime_error("cannot start cartvo with a pipe");
    if (pid_ == 0) {
      dup2(pipe[1], STDERR_FILENO);
      becomeShell(command);
    }
    close(pipe[1]);
    errors_ = pipe[0];
  }
  ~PipedCartvo() {
    close(errors_);
    if (pid_ < 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  PipedCartvo(const PipedCartvo&) = delete;
  PipedCartvo& operator=(const PipedCartvo&) = delete;

  /// Reads up to the first line that contains `part` and returns it; empty if there is none.
  std::string awaitLine(const std::string& part) {
    std::string line;
    for (char next = 0; read(errors_, &next, 1) == 1;) {
      if (next != '\n') {
        line += next;
        continue;
      }
      if (line.find(part) != std::string::npos) return line;
      line.clear();
    }
    return {};
  }

  void send(int signal) const { kill(pid_, signal); }

  /// Waits for the end; the exit code and the rest of the error output.
  CommandResult finish() {
    const std::string rest = readToEnd(errors_);
    return {awaitExit(std::exchange(pid_, -1)), rest};
  }

 private:
  pid_t pid_ = -1;
  int errors_ = -1;
};

}  // namespace cartvo::test
