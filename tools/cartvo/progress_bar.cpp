// Prints a progress line on standard error.

#include "tools/cartvo/progress_bar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <unistd.h>

namespace cartvo {
namespace {

std::string progressLine(std::size_t done, std::size_t expected, const std::string& unit, double seconds) {
  constexpr std::size_t kWidth = 30;
  const double rate = static_cast<double>(done) / std::max(seconds, 1e-3);
  char line[200];
  if (expected == 0) {
    std::snprintf(line, sizeof line, "%zu %s, %.1f/s", done, unit.c_str(), rate);
    return line;
  }
  const std::size_t filled = std::min(kWidth, kWidth * done / expected);
  const std::size_t remaining = expected - std::min(done, expected);
  const long left = rate > 0.0 ? std::lround(static_cast<double>(remaining) / rate) : 0;
  std::snprintf(line, sizeof line, "[%s%s] %zu/%zu %s, %.1f/s, %ld:%02ld left",
                std::string(filled, '#').c_str(), std::string(kWidth - filled, '.').c_str(), done, expected,
                unit.c_str(), rate, left / 60, left % 60);
  return line;
}

}  // namespace

ProgressBar::ProgressBar(std::string unit)
    : unit_(std::move(unit)), is_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (drawn_ && is_terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done, std::size_t expected) {
  const auto pause = is_terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10'000);
  const Clock::time_point now = Clock::now();
  if (now - last_drawn_ < pause) return;
  last_drawn_ = now;
  drawn_ = true;
  const std::string line =
      progressLine(done, expected, unit_, std::chrono::duration<double>(now - start_).count());
  std::fprintf(stderr, is_terminal_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
}

}  // namespace cartvo
