// Guides the person who holds the board during a live calibration.

#include "tools/calibrate/views/view_guide.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "common/command_line/terminal.hpp"

namespace cartvo {
namespace {

constexpr std::size_t kUnlimited = 1000;  // columns

}  // namespace

std::string guideLine(const StreamProgress& progress, std::size_t columns) {
  const std::string views = fmt::format("{:.0f} s, {} views", progress.seconds, progress.so_far.views.size());
  const std::string corners = fmt::format("; corners: left {}, right {}", progress.left.corners.size(),
                                          progress.right.corners.size());
  const std::string advice = "; " + progress.advice;
  const std::string full = views + corners + advice;
  return textColumns(full) <= columns ? full : cutToColumns(views + advice, columns);
}

ViewGuide::ViewGuide() : is_terminal_(isatty(STDERR_FILENO) == 1), last_drawn_(Clock::now()) {}

void ViewGuide::show(const StreamProgress& progress) {
  if (progress.has_new_view) printView(progress);
  const auto pause = is_terminal_ ? std::chrono::milliseconds(150) : std::chrono::milliseconds(10'000);
  if (Clock::now() - last_drawn_ < pause) return;
  last_drawn_ = Clock::now();
  drawn_ = true;
  const std::string line = guideLine(progress, is_terminal_ ? lineColumns(stderr) : kUnlimited);
  std::fprintf(stderr, is_terminal_ ? "\r\033[K%s" : "cartvo: %s\n", line.c_str());
  std::fflush(stderr);
}

void ViewGuide::printView(const StreamProgress& progress) {
  end();
  const BoardViews& so_far = progress.so_far;
  if (progress.rejection.empty()) {
    std::fprintf(stderr, "cartvo: view %zu taken at %.0f s; %s\n", so_far.views.size(), progress.seconds,
                 progress.next_view_advice.empty() ? "enough views" : progress.next_view_advice.c_str());
  } else {
    std::fprintf(stderr, "cartvo: view at %.0f s rejected: %s\n", progress.seconds,
                 progress.rejection.c_str());
  }
}

void ViewGuide::end() {
  if (drawn_ && is_terminal_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

}  // namespace cartvo
