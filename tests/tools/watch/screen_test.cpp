// The full-screen view of `cartvo watch`.
#include "tools/watch/screen.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/command_line/terminal.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

WatchedState exampleState() {
  WatchedState state;
  state.url = "udpm://239.255.76.67:7667?ttl=0";
  state.message.status = odometry_t::VALID;
  state.message.quality = 60;
  state.message.velocity_bound[0] = 0.12;
  state.message.motion_bound[1] = 0.03;
  state.message.sequence = 5;
  state.message.orientation_world_body[0] = 1.0;
  state.message.velocity_body[0] = 3.214;
  state.message.offset_us = 400;
  for (int i = 0; i < 6; ++i)
    state.message.pose_covariance_body[7 * i] = state.message.twist_covariance_body[7 * i] = 1e-4;
  state.message.time_to_live_us = 300'000;
  state.frame_rate = 18.0;
  state.health.emplace();
  state.health->left.state = state.health->right.state = camera_health_t::STREAMING;
  return state;
}

std::string textOf(const WatchedState& state, std::size_t columns, std::size_t rows, bool is_coloured) {
  std::string text;
  for (const std::string& line : screenLines(state, SpeedHistory(), columns, rows, is_coloured))
    text += line + "\n";
  return text;
}

TEST(WatchScreen, ShowsMotionTimesAndBothCameras) {
  EXPECT_THAT(textOf(exampleState(), 100, 40, false),
              AllOf(HasSubstr("+3.21 m/s forward"), HasSubstr("deg/s"), HasSubstr("+0.40 ms"),
                    HasSubstr("18.0 pairs/s"), HasSubstr("state       tracking"),
                    HasSubstr("left        streaming"), HasSubstr("right       streaming"),
                    HasSubstr("±0.12 m/s, 0.0 deg/s; last second 0.030 m, 0.00 deg; quality 60"),
                    HasSubstr("no problem"), Not(HasSubstr("\x1b"))));
}

TEST(WatchScreen, SaysWhyAMessageIsNotValidAndThatNoneComes) {
  WatchedState state = exampleState();
  state.message.status = odometry_t::INVALID;
  state.message.reasons = odometry_t::REASON_TOO_FEW_FEATURES;
  state.message.velocity_body[0] = std::nan("");
  EXPECT_THAT(textOf(state, 100, 40, false), AllOf(HasSubstr("not valid: too few features"),
                                                   HasSubstr("– m/s forward"), Not(HasSubstr("nan"))));
  state.message.reasons = odometry_t::REASON_BOUND;
  state.health->bound_exceeded = "yaw rate is known to 4.10 deg/s, alert limit 3.00 deg/s";
  EXPECT_THAT(textOf(state, 100, 40, false),
              HasSubstr("not valid: bound above its alert limit: yaw rate is known to 4.10 deg/s"));
  state.message_age = 3.2;
  EXPECT_THAT(textOf(state, 100, 40, false), HasSubstr("no message for 3 s"));
}

TEST(WatchScreen, HasNoTimesOfAPairThatDidNotCome) {
  WatchedState state = exampleState();
  state.message.status = odometry_t::INVALID;
  state.message.reasons = odometry_t::REASON_NO_PAIR;
  state.message.publication_utime = 1'900'000'000'000'000;
  EXPECT_THAT(textOf(state, 100, 40, false),
              AllOf(HasSubstr("latency –\n"), HasSubstr("offset      –\n"), Not(HasSubstr("a recording"))));
  state.message.reasons = 0;
  EXPECT_THAT(textOf(state, 100, 40, false), HasSubstr("latency none: a recording\n"));
}

TEST(WatchScreen, FitsTheTerminalAndWrapsSentences) {
  WatchedState state = exampleState();
  state.advice = "problem: " + std::string(30, 'a') + " " + std::string(30, 'b') + " the end";
  for (const std::size_t rows : {16U, 24U, 40U}) {
    const std::vector<std::string> lines = screenLines(state, SpeedHistory(), 50, rows, false);
    EXPECT_LE(lines.size(), rows);
    for (const std::string& line : lines)
      EXPECT_LE(textColumns(line), 50u) << line;
  }
  EXPECT_THAT(textOf(state, 50, 40, false), HasSubstr(" " + std::string(30, 'b') + " the end\n"));
}

TEST(WatchScreen, IsColouredOnlyIfAsked) {
  EXPECT_THAT(textOf(exampleState(), 100, 40, true), HasSubstr("\x1b[30;42m"));
}

/// Output of a child process on a pseudo terminal of this size.
std::string printedOnTerminal(unsigned short columns, unsigned short rows, const char* terminal,
                              const std::function<void()>& print) {
  winsize size{};
  size.ws_col = columns;
  size.ws_row = rows;
  int descriptor = -1;
  const pid_t child = ::forkpty(&descriptor, nullptr, nullptr, &size);
  if (child == 0) {
    ::setenv("TERM", terminal, 1);
    ::setenv("NO_COLOR", "1", 1);
    print();
    std::fflush(stdout);
    ::_exit(0);
  }
  std::string printed;
  char part[4096];
  for (ssize_t bytes = 0; (bytes = ::read(descriptor, part, sizeof part)) > 0;)  // EIO at the child's end
    printed.append(part, static_cast<std::size_t>(bytes));
  ::waitpid(child, nullptr, 0);
  ::close(descriptor);
  return printed;
}

TEST(WatchScreen, IsShownOnATerminalAndLeavesItAsItWasAfterAnError) {
  const std::string printed = printedOnTerminal(80, 24, "xterm", [] {
    if (!canShowScreen()) return;
    try {
      Screen screen;
      screen.draw(exampleState(), SpeedHistory());
      throw std::runtime_error("an error");
    } catch (const std::runtime_error&) {
      return;
    }
  });
  EXPECT_THAT(printed, AllOf(StartsWith("\x1b[?1049h\x1b[?25l"), HasSubstr(" valid "),
                             EndsWith("\x1b[?25h\x1b[?1049l"), Not(HasSubstr("\x1b[30;42m"))));
}

TEST(WatchScreen, IsNotShownOnSmallOrDumbTerminals) {
  const auto answer = [] { std::fputs(canShowScreen() ? "screen" : "line", stdout); };
  EXPECT_EQ(printedOnTerminal(80, 24, "xterm", answer), "screen");
  EXPECT_EQ(printedOnTerminal(80, 24, "dumb", answer), "line");
  EXPECT_EQ(printedOnTerminal(40, 24, "xterm", answer), "line");
  EXPECT_EQ(printedOnTerminal(80, 5, "xterm", answer), "line");
}

TEST(SpeedHistory, DrawsBarsUpToTheLargestSpeed) {
  SpeedHistory speeds;
  std::int64_t now_ns = 0;
  for (const double speed : {0.0, 1.0, std::nan(""), 2.0}) {
    speeds.add(speed, now_ns);
    now_ns += 500'000'000;
  }
  EXPECT_EQ(speeds.sparkline(10), "▁▅ █");
  EXPECT_EQ(speeds.sparkline(2), " █");
  EXPECT_DOUBLE_EQ(speeds.largest(), 2.0);
}

}  // namespace
}  // namespace cartvo
