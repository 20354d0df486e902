#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include "support/file_text.hpp"
#include "support/places.hpp"
#include "support/test_timeout.hpp"
#include "support/tools/child_process.hpp"

namespace cartvo::test {

/// The built `cartvo`, running in the background while the test continues. The destructor kills it if it
/// still runs.
class RunningCartvo {
 public:
  /// `output_file` receives its standard and error output.
  RunningCartvo(const std::string& arguments, std::filesystem::path output_file)
      : output_file_(std::move(output_file)) {
    const std::string command = std::string("exec ") + cartvoProgram().string() + " " + arguments + " > " +
                                output_file_.string() + " 2>&1";
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("cannot fork a process for cartvo");
    if (pid_ == 0) becomeShell(command);
  }
  ~RunningCartvo() {
    if (is_over_) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  RunningCartvo(const RunningCartvo&) = delete;
  RunningCartvo& operator=(const RunningCartvo&) = delete;

  /// The output so far.
  std::string output() const { return contentsOf(output_file_); }

  bool isRunning() const {
    siginfo_t ended{};
    return waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0;
  }
  /// Sends SIGINT.
  void interrupt() const { kill(pid_, SIGINT); }

  /// Waits for the end and returns the exit code; -1 if it does not end within kTestTimeout.
  int wait() {
    const auto end = std::chrono::steady_clock::now() + kTestTimeout;
    while (std::chrono::steady_clock::now() < end) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        is_over_ = true;
        return exitCodeOf(status);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return -1;
  }

 private:
  std::filesystem::path output_file_;
  pid_t pid_ = -1;
  bool is_over_ = false;
};

}  // namespace cartvo::test
