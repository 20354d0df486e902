#include "tools/cartvo/progress_bar.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <unistd.h>

namespace cartvo {

ProgressBar::ProgressBar(std::string unit)
    : unit_(std::move(unit)), is_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done, std::size_t expected) {
  constexpr std::chrono::milliseconds kPause{100};
  const Clock::time_point now = Clock::now();
  if (!is_terminal_ || (drawn_ && now - last_drawn_ < kPause)) return;
  last_drawn_ = now;
  drawn_ = true;
  const double rate =
      static_cast<double>(done) / std::max(std::chrono::duration<double>(now - start_).count(), 1e-3);
  if (expected == 0) {
    std::fprintf(stderr, "\r\033[K%zu %s, %.1f/s", done, unit_.c_str(), rate);
    return;
  }
  constexpr std::size_t kWidth = 30;
  const std::size_t filled = std::min(kWidth, kWidth * done / expected);
  std::fprintf(stderr, "\r\033[K[%s%s] %zu/%zu %s, %.1f/s", std::string(filled, '#').c_str(),
               std::string(kWidth - filled, '.').c_str(), done, expected, unit_.c_str(), rate);
}

}  // namespace cartvo
