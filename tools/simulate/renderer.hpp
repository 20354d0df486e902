#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cartvo::simulate {

/// The program cartvo-render, which renders drives, as a child process. It checks its options itself. Signals
/// that Interruption receives are passed on to it.
class Renderer {
 public:
  /// Finds the program: beside the running one or in its build folder, else on $PATH. Throws
  /// std::runtime_error that says what provides it.
  Renderer();

  /// Runs it; progress and messages are printed as by itself. Throws ExitCode with its exit code unless that
  /// is 0.
  void run(const std::vector<std::string>& arguments) const;

  /// As run(), but returns what it writes to standard output.
  std::string outputOf(const std::vector<std::string>& arguments) const;

 private:
  std::filesystem::path program_;
};

}  // namespace cartvo::simulate
