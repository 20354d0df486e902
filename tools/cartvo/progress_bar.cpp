// Prints a progress line on standard error.

#include "tools/cartvo/progress_bar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
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

/// Time between the lines of an output that is no terminal.
std::chrono::milliseconds lineInterval() {
  constexpr double kUsual = 10.0, kMax = 86'400.0;  // s
  double seconds = kUsual;
  if (const char* given = std::getenv("CARTVO_PROGRESS_INTERVAL"); given != nullptr && *given != '\0') {
    char* end = nullptr;
    seconds = std::strtod(given, &end);
    if (*end != '\0' || !(seconds >= 0.0 && seconds <= kMax)) seconds = kUsual;
  }
  return std::chrono::milliseconds(std::lround(1e3 * seconds));
}

/// The name of a step before its progress, cut so that count and remaining time have room.
std::string labelOf(const std::string& name, std::size_t columns) {
  constexpr std::size_t kForProgress = 40;  // columns
  return name.empty() ? "" : cutToColumns(name + ": ", columns - std::min(columns, kForProgress));
}

}  // namespace

std::string progressLine(std::size_t done, std::size_t expected, const std::string& unit, double seconds,
                         std::size_t columns) {
  const double rate = static_cast<double>(done) / std::max(seconds, 1e-3);
  const bool is_time = unit == "s";
  const std::string rate_text = is_time ? "" : formatted(", %.1f/s", rate);
  if (expected == 0) return cutToColumns(formatted("%zu %s", done, unit.c_str()) + rate_text, columns);
  const std::size_t remaining = expected - std::min(done, expected);
  const double left_per_unit = is_time ? 1.0 : rate > 0.0 ? 1.0 / rate : 0.0;
  const long left = std::lround(static_cast<double>(remaining) * left_per_unit);
  const std::string left_text = formatted(", %ld:%02ld left", left / 60, left % 60);
  const std::string count = formatted("%zu/%zu %s", done, expected, unit.c_str());
  constexpr std::size_t kBarFrame = 3;  // brackets and a space
  for (const std::string& text : {count + rate_text + left_text, count + left_text}) {
    const std::size_t taken = textColumns(text) + kBarFrame;
    if (taken + kMinBar <= columns) return bar(done, expected, std::min(kMaxBar, columns - taken)) + text;
  }
  return cutToColumns(count + left_text, columns);
}

ProgressBar::ProgressBar(std::string unit) : ProgressBar(WorkStep{"", std::move(unit)}) {}

ProgressBar::ProgressBar(WorkStep step)
    : step_(std::move(step)),
      is_terminal_(isatty(STDERR_FILENO) == 1),
      pause_(is_terminal_ ? std::chrono::milliseconds(100) : lineInterval()) {
  if (!step_.name.empty()) draw(cutToColumns(step_.name, lineColumns(stderr)));
}

ProgressBar::~ProgressBar() {
  if (drawn_ && is_terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done, std::size_t expected) {
  const Clock::time_point now = Clock::now();
  const bool ends = shown_ && expected > 0 && done == expected && !ended_;
  if (now - last_shown_ < pause_ && !ends) return;
  last_shown_ = now;
  shown_ = true;
  ended_ = ended_ || ends;
  const std::size_t columns = lineColumns(stderr);
  const std::string label = is_terminal_ ? labelOf(step_.name, columns) : "";
  draw(label + progressLine(done, expected, step_.unit, std::chrono::duration<double>(now - start_).count(),
                            columns - textColumns(label)));
}

void ProgressBar::draw(const std::string& line) {
  drawn_ = true;
  std::fprintf(stderr, is_terminal_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
}

}  // namespace cartvo
