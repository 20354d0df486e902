#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace cartvo::daemon {

/// Content of the status page. Called by the server's threads.
class PageContent {
 public:
  virtual ~PageContent() = default;

  /// Properties that do not change while the program runs, as JSON.
  virtual std::string about() = 0;
  /// The newest frame (frameBytes) unless its number is `seen`; nothing: no newer one.
  virtual std::optional<std::string> newestFrame(std::uint64_t seen) = 0;
  /// The stored frame of a replayed pair; nothing: not stored.
  virtual std::optional<std::string> storedFrame(std::uint64_t pair) = 0;
  /// The last minute and the path, as JSON (PageHistory).
  virtual std::string history() = 0;
  /// Cameras, clocks, self-checks, recording, replay, as JSON.
  virtual std::string health() = 0;
  /// Carries out what a button asks for. Returns the reason why it is not done; empty: it is done.
  virtual std::string control(const std::string& action) = 0;
};

}  // namespace cartvo::daemon
