// Log lines about a camera that is polled once a second.

#include "daemon/diagnostics/camera_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cartvo::daemon {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Line = CameraLog::Line;

constexpr auto kInfo = spdlog::level::info;
constexpr auto kWarning = spdlog::level::warn;

capture::CameraHealth health(capture::CameraState state, const std::string& last_error,
                             std::uint64_t reconnections) {
  capture::CameraHealth health;
  health.state = state;
  health.last_error = last_error;
  health.reconnections = reconnections;
  return health;
}

class CameraLogTest : public testing::Test {
 protected:
  /// Polls one second after the previous poll.
  std::vector<Line> poll(capture::CameraState state, const std::string& last_error,
                         std::uint64_t reconnections) {
    now_ += std::chrono::seconds(1);
    return log_.due(health(state, last_error, reconnections), now_);
  }

  CameraLog log_{"left camera"};
  CameraLog::Clock::time_point now_;
};

TEST_F(CameraLogTest, LogsEachStateChangeOnceAndLastingFaultEachMinute) {
  EXPECT_THAT(poll(capture::CameraState::connecting, "", 0),
              ElementsAre(Line{kInfo, "left camera: connecting"}));
  EXPECT_THAT(poll(capture::CameraState::streaming, "", 0),
              ElementsAre(Line{kInfo, "left camera: streaming"}));
  EXPECT_THAT(poll(capture::CameraState::streaming, "", 0), IsEmpty());
  EXPECT_THAT(poll(capture::CameraState::stalled, "no picture", 1),
              ElementsAre(Line{kWarning, "left camera: stalled: no picture"}));
  for (int i = 1; i < 60; ++i)
    EXPECT_THAT(poll(capture::CameraState::stalled, "no picture", 1), IsEmpty());
  EXPECT_THAT(
      poll(capture::CameraState::stalled, "no picture", 1),
      ElementsAre(Line{kWarning, "left camera: stalled: no picture (60 times since this was last logged)"}));
  EXPECT_THAT(poll(capture::CameraState::streaming, "no picture", 1),
              ElementsAre(Line{kInfo, "left camera: streaming"}));
  EXPECT_THAT(poll(capture::CameraState::stalled, "no picture", 2),
              ElementsAre(Line{kWarning, "left camera: stalled: no picture"}))
      << "a recurring fault is logged again";
}

TEST_F(CameraLogTest, LogsFaultThatEndedBetweenTwoPolls) {
  poll(capture::CameraState::streaming, "", 0);
  EXPECT_THAT(poll(capture::CameraState::streaming, "the driver failed", 1),
              ElementsAre(Line{kWarning, "left camera: streaming again after a fault: the driver failed"}));
  EXPECT_THAT(poll(capture::CameraState::streaming, "the driver failed", 1), IsEmpty());
  EXPECT_THAT(
      poll(capture::CameraState::streaming, "no picture", 4),
      ElementsAre(Line{kWarning, "left camera: streaming again after 3 faults, the last: no picture"}));
}

TEST_F(CameraLogTest, LogsFaultThatEndedBeforeStreamingResumed) {
  poll(capture::CameraState::streaming, "", 0);
  poll(capture::CameraState::connecting, "the cable", 1);
  EXPECT_THAT(poll(capture::CameraState::streaming, "no picture", 2),
              ElementsAre(Line{kWarning, "left camera: streaming again after a fault: no picture"}));
}

TEST_F(CameraLogTest, LimitsLinesOfRepeatedFaultsAndCountsThemAll) {
  poll(capture::CameraState::streaming, "", 0);
  std::vector<std::string> texts;
  for (std::uint64_t i = 1; i <= 60; ++i) {
    for (const Line& line : poll(capture::CameraState::streaming, "no picture", i))
      texts.push_back(line.text);
  }
  const auto again = [](const std::string& faults) {
    return "left camera: streaming again after " + faults + ": no picture";
  };
  EXPECT_THAT(texts, ElementsAre(again("a fault"), again("a fault"), again("a fault"), again("a fault"),
                                 again("a fault"), again("5 faults, the last"), again("10 faults, the last"),
                                 again("10 faults, the last"), again("10 faults, the last"),
                                 again("10 faults, the last"), again("10 faults, the last")));
}

}  // namespace
}  // namespace cartvo::daemon
