#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <cartvo/health_t.hpp>

#include "tools/watch/odometry_statistics.hpp"

// The full-screen view of `cartvo watch`.

namespace cartvo {

/// Speeds of the last minute for a sparkline.
class SpeedHistory {
 public:
  /// `speed`: m/s, NaN if the message is not valid; `now_ns`: any clock.
  void add(double speed, std::int64_t now_ns);

  /// The newest `columns` values as bars from 0 to the largest one, blank where no message was valid, and the
  /// largest one, m/s.
  std::string sparkline(std::size_t columns) const;
  double largest() const;

 private:
  std::deque<double> speeds_;  ///< one for each kStep_ns, newest last
  std::optional<std::int64_t> last_ns_;
};

/// Content of the screen.
struct WatchedState {
  std::string url;
  odometry_t message{};            ///< the last one
  double message_age = 0.0;        ///< s since it came
  double frame_rate = 0.0;         ///< pairs in the last second
  OdometrySummary counts;          ///< numbers since the start
  std::optional<health_t> health;  ///< the last one
  std::string advice;              ///< sentences, one a line
};

/// The lines of the screen, cut to the terminal. `is_coloured`: with ANSI escapes for colours.
std::vector<std::string> screenLines(const WatchedState& state, const SpeedHistory& speeds,
                                     std::size_t columns, std::size_t rows, bool is_coloured);

/// Whether standard output is a terminal on which a full-screen view can be shown: of enough columns and
/// rows, and not TERM=dumb.
bool canShowScreen();

/// Shows lines on the terminal's alternate screen, which the destructor leaves.
class Screen {
 public:
  Screen() = default;
  ~Screen() { leave(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Draws the state at the terminal's present size.
  void draw(const WatchedState& state, const SpeedHistory& speeds);
  /// Restores the terminal; the next draw() enters again.
  void leave();

 private:
  bool is_entered_ = false;
};

}  // namespace cartvo
