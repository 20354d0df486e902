#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include "support/patience.hpp"
#include "support/places.hpp"

namespace cartvo::test {

/// The built `cartvo`, run through the shell while the test goes on; killed if it still runs at the end.
class RunningCartvo {
 public:
  /// `output`: the file that takes what it says on both outputs.
  RunningCartvo(const std::string& arguments, std::filesystem::path output) : output_(std::move(output)) {
    const std::string command = std::string("exec ") + cartvoProgram().string() + " " + arguments + " > " +
                                output_.string() + " 2>&1";
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("cannot fork");
    if (pid_ == 0) {
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
  }
  ~RunningCartvo() {
    if (is_over_) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  RunningCartvo(const RunningCartvo&) = delete;
  RunningCartvo& operator=(const RunningCartvo&) = delete;

  std::string said() const {
    std::ifstream file(output_);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  void interrupt() const { kill(pid_, SIGINT); }

  /// The exit code; -1 if it does not end within kPatience.
  int wait() {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        is_over_ = true;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return -1;
  }

 private:
  std::filesystem::path output_;
  pid_t pid_ = -1;
  bool is_over_ = false;
};

}  // namespace cartvo::test
