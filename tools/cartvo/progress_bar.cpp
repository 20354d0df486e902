// Prints a progress line on standard error.

#include "tools/cartvo/progress_bar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <unistd.h>

#include "common/command_line/terminal.hpp"

namespace cartvo {
namespace {

constexpr std::size_t kMaxBar = 30, kMinBar = 5;  // columns

std::string formatted(const char* format, auto... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string bar(std::size_t done, std::size_t expected, std::size_t columns) {
  const std::size_t filled = std::min(columns, columns * done / expected);
  std::string text = "[";
  return text.append(filled, '#').append(columns - filled, '.').append("] ");
}

}  // namespace

std::string progressLine(std::size_t done, std::size_t expected, const std::string& unit, double seconds,
                         std::size_t columns) {
  const double rate = static_cast<double>(done) / std::max(seconds, 1e-3);
  const std::string rate_text = formatted(", %.1f/s", rate);
  if (expected == 0) return cutToColumns(formatted("%zu %s", done, unit.c_str()) + rate_text, columns);
  const std::size_t remaining = expected - std::min(done, expected);
  const long left = rate > 0.0 ? std::lround(static_cast<double>(remaining) / rate) : 0;
  const std::string left_text = formatted(", %ld:%02ld left", left / 60, left % 60);
  const std::string count = formatted("%zu/%zu %s", done, expected, unit.c_str());
  constexpr std::size_t kBarFrame = 3;  // brackets and a space
  for (const std::string& text : {count + rate_text + left_text, count + left_text}) {
    const std::size_t taken = textColumns(text) + kBarFrame;
    if (taken + kMinBar <= columns) return bar(done, expected, std::min(kMaxBar, columns - taken)) + text;
  }
  return cutToColumns(count + left_text, columns);
}

ProgressBar::ProgressBar(std::string unit)
    : unit_(std::move(unit)), is_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (drawn_ && is_terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done, std::size_t expected) {
  const auto pause = is_terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10'000);
  const Clock::time_point now = Clock::now();
  const bool ends = drawn_ && expected > 0 && done == expected && !ended_;
  if (now - last_drawn_ < pause && !ends) return;
  last_drawn_ = now;
  drawn_ = true;
  ended_ = ends;
  const std::string line = progressLine(
      done, expected, unit_, std::chrono::duration<double>(now - start_).count(), lineColumns(stderr));
  std::fprintf(stderr, is_terminal_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
}

}  // namespace cartvo
