#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>

#include <spdlog/common.h>

namespace cartvo {

/// Sends spdlog's lines to standard error: for the journal with its priority prefix (sd-daemon(3)) and
/// nothing that the journal adds itself, else with date and time.
void setUpLog(spdlog::level::level_enum level);

/// Warnings that a fault may repeat with each frame: each text is logged at once the first time, then at most
/// once a minute with the number of repeats. One thread. Remembers a bounded number of texts.
class RepeatedWarnings {
 public:
  using Clock = std::chrono::steady_clock;

  /// The text to log now, or empty. Pure, for tests; `warn` logs it.
  std::string due(const std::string& text, Clock::time_point now);
  void warn(const std::string& text);

  /// The fault is over: should it come back, that is news.
  void forget(const std::string& text) { entries_.erase(text); }

 private:
  struct Entry {
    Clock::time_point logged;
    std::uint64_t repeats = 0;
  };
  std::map<std::string, Entry> entries_;
};

}  // namespace cartvo
