#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>

#include <spdlog/common.h>

namespace cartvo::daemon {

/// Sends spdlog's lines to the journal if standard error goes there, see makeJournalSink(); otherwise to
/// standard error with date and time.
void setUpLog(spdlog::level::level_enum level);

/// Rate limit for warnings that may repeat with each frame: each text is logged at once the first time, then
/// at most once a minute with the number of repeats. Texts that differ in their numbers alone are the same
/// warning; addresses and names are not numbers. Stores a bounded number of texts. Not thread-safe.
class RepeatedWarnings {
 public:
  using Clock = std::chrono::steady_clock;

  /// Returns the line to log now, or empty. Does not log, for tests; `warn` does.
  std::string due(const std::string& text, Clock::time_point now);
  void warn(const std::string& text);

  /// Call when the fault is over: the text is logged at once if it recurs.
  void forget(const std::string& text);

 private:
  struct Entry {
    Clock::time_point logged;
    std::uint64_t repeats = 0;
  };
  std::map<std::string, Entry> entries_;  ///< by the text without its numbers
};

}  // namespace cartvo::daemon
