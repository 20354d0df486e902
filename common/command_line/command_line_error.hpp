#pragma once

#include <stdexcept>
#include <string>

namespace cartvo {

/// A wrong command line. Its text says what is wrong.
class CommandLineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  CommandLineError(const std::string& option, const std::string& problem)
      : runtime_error(option + ": " + problem) {}
};

/// Ends the program with an exit code, after all messages were printed.
class ExitCode : public std::runtime_error {
 public:
  explicit ExitCode(int code) : runtime_error("exit code " + std::to_string(code)), code_(code) {}

  int code() const { return code_; }

 private:
  int code_;
};

}  // namespace cartvo
