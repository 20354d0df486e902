#pragma once

#include <csignal>

namespace cartvo {

/// Turns the first SIGINT (Ctrl-C), SIGTERM or SIGHUP into an exception at the next check(), so that
/// destructors remove what is half written. A second one ends the program at once. For one object at a time;
/// the destructor restores the signals' actions. Signals that are ignored stay ignored.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// After a signal: prints that nothing was written and throws ExitCode with the exit code 128 +
  /// signal.
  void check() const;

  /// The signal that was received; 0: none.
  int received() const;

 private:
  struct sigaction interrupt_ {
  }, terminate_{}, hang_up_{};  ///< before
};

}  // namespace cartvo
