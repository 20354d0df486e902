// Log of cartvod: what cameras, the validity of odometry and the journal get, and repeated lines.
#include "daemon/diagnostics/log.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "daemon/diagnostics/camera_log.hpp"
#include "daemon/diagnostics/journal.hpp"
#include "daemon/diagnostics/validity_log.hpp"

namespace cartvo::daemon {
namespace {

using Line = CameraLog::Line;
using Lines = std::vector<std::vector<std::string>>;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

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

/// Sends the log to a journal that keeps its lines, and restores it.
class Journal : public testing::Test {
 protected:
  void SetUp() override { logTo(true); }
  void TearDown() override { spdlog::set_default_logger(before_); }

  void logTo(bool takes_lines) {
    auto sink = makeJournalSink([this, takes_lines](const std::vector<std::string>& fields) {
      if (takes_lines) lines_.push_back(fields);
      return takes_lines;
    });
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", std::move(sink)));
  }

  Lines lines_;

 private:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
};

TEST_F(Journal, KeepsTheFieldsOfAnEvent) {
  logEvent(spdlog::level::warn, "the text", {{"CARTVO_EVENT", "test"}, {"CARTVO_CAMERA", "left"}});
  EXPECT_EQ(lines_, (Lines{{"MESSAGE=the text", "PRIORITY=4", "SYSLOG_IDENTIFIER=cartvod",
                            "CARTVO_EVENT=test", "CARTVO_CAMERA=left"}}));
}

TEST_F(Journal, GivesLaterLinesNoFieldsOfAnEarlierOne) {
  logEvent(spdlog::level::info, "first", {{"CARTVO_EVENT", "test"}});
  spdlog::error("second");
  EXPECT_EQ(lines_.at(1),
            (std::vector<std::string>{"MESSAGE=second", "PRIORITY=3", "SYSLOG_IDENTIFIER=cartvod"}));
}

TEST_F(Journal, TakesBracesInATextAsTheyAre) {
  logEvent(spdlog::level::info, "a {} brace", {});
  EXPECT_EQ(lines_.at(0).at(0), "MESSAGE=a {} brace");
}

TEST_F(Journal, NamesTheCameraAndItsState) {
  capture::CameraHealth health;
  health.state = capture::CameraState::stalled;
  health.last_error = "no picture for 2 s";
  CameraLog("left camera").log(health);
  ASSERT_EQ(lines_.size(), 1U);
  EXPECT_EQ(lines_[0][3], "CARTVO_EVENT=camera_state");
  EXPECT_EQ(lines_[0][4], "CARTVO_CAMERA=left");
  EXPECT_EQ(lines_[0][5], "CARTVO_CAMERA_STATE=stalled");
}

TEST_F(Journal, WritesTheTextToStandardErrorWhereTheJournalTakesNone) {
  logTo(false);
  testing::internal::CaptureStderr();
  logEvent(spdlog::level::err, "the text", {{"CARTVO_EVENT", "test"}});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "<3>the text\n");
}

TEST(RepeatedWarnings, LogsFirstAtOnceThenOncePerMinuteWithCount) {
  RepeatedWarnings warnings;
  const RepeatedWarnings::Clock::time_point start;
  EXPECT_EQ(warnings.due("no partner", start), "no partner");
  for (int i = 1; i < 100; ++i)
    EXPECT_EQ(warnings.due("no partner", start + i * std::chrono::milliseconds(500)), "");
  EXPECT_EQ(warnings.due("no partner", start + std::chrono::minutes(1)),
            "no partner (100 times since this was last logged)");
  EXPECT_EQ(warnings.due("no partner", start + std::chrono::minutes(1)), "");
}

TEST(RepeatedWarnings, LogsRecurringFaultAtOnceAfterForget) {
  RepeatedWarnings warnings;
  const RepeatedWarnings::Clock::time_point start;
  warnings.due("no answer", start);
  warnings.forget("no answer");
  EXPECT_EQ(warnings.due("no answer", start + std::chrono::seconds(1)), "no answer");
}

TEST(RepeatedWarnings, DistinguishesTextsAndStoresLimitedNumber) {
  RepeatedWarnings warnings;
  const RepeatedWarnings::Clock::time_point now;
  for (int i = 0; i < 1000; ++i)
    EXPECT_NE(warnings.due("camera" + std::to_string(i), now), "");
  EXPECT_EQ(warnings.due("camera999", now), "");
}

TEST(RepeatedWarnings, TakesTextsWithOtherNumbersForTheSame) {
  RepeatedWarnings warnings;
  const RepeatedWarnings::Clock::time_point now;
  EXPECT_NE(warnings.due("the clocks differ by 25.3 ms (-12, \u00b10.4): 7 %", now), "");
  EXPECT_EQ(warnings.due("the clocks differ by 5 ms (3, \u00b11e-3): 80 %", now), "");
  EXPECT_NE(warnings.due("no answer of 10.0.0.1:554", now), "");
  EXPECT_NE(warnings.due("no answer of 10.0.0.2:554", now), "");
  warnings.forget("the clocks differ by 1 ms (2, \u00b13): 4 %");
  EXPECT_NE(warnings.due("the clocks differ by 25.3 ms (-12, \u00b10.4): 7 %", now), "");
}

odometry_t valid() {
  odometry_t message{};
  message.status = odometry_t::VALID;
  return message;
}

odometry_t invalid() {
  odometry_t message{};
  message.status = odometry_t::INVALID;
  message.reasons = odometry_t::REASON_NO_PAIR;
  return message;
}

TEST(ValidityLog, LogsChangeAtOnceAndOnce) {
  ValidityLog log;
  const ValidityLog::Clock::time_point start;
  EXPECT_EQ(log.due(invalid(), "", start), "odometry is not valid: no pair");
  EXPECT_EQ(log.due(invalid(), "", start + milliseconds(50)), "");
  EXPECT_EQ(log.due(valid(), "", start + milliseconds(100)), "odometry is valid");
  EXPECT_TRUE(log.isValid());
  for (int i = 3; i < 1000; ++i)
    EXPECT_EQ(log.due(valid(), "", start + i * milliseconds(50)), "");
}

TEST(ValidityLog, NamesTheOffsetAndItsKey) {
  odometry_t message = invalid();
  message.reasons = odometry_t::REASON_OFFSET_TOO_LARGE;
  message.offset_us = -123'400;
  EXPECT_EQ(
      ValidityLog().due(message, "", {}),
      "odometry is not valid: offset too large (the right image is exposed 123.4 ms before the left one; "
      "odometry.maximum_offset allows less)");
}

TEST(ValidityLog, NamesTheBoundAboveItsAlertLimit) {
  odometry_t message = invalid();
  message.reasons = odometry_t::REASON_BOUND;
  EXPECT_EQ(
      ValidityLog().due(message, "yaw rate is known to 4.10 deg/s, alert limit 3.00 deg/s", {}),
      "odometry is not valid: bound above its alert limit (yaw rate is known to 4.10 deg/s, alert limit "
      "3.00 deg/s)");
}

TEST(ValidityLog, LogsNumberOfFrequentChanges) {
  ValidityLog log;
  const ValidityLog::Clock::time_point start;
  std::vector<std::string> lines;
  const auto at = [&](milliseconds time, const odometry_t& message) {
    if (std::string line = log.due(message, "", start + time); !line.empty())
      lines.push_back(std::move(line));
  };
  for (int i = 0; i < 600; ++i)  // a minute, ten messages a second
    at(i * milliseconds(100), i % 2 == 0 ? invalid() : valid());
  EXPECT_THAT(lines, ElementsAre("odometry is not valid: no pair", "odometry is valid",
                                 "odometry is not valid: no pair", "odometry is valid",
                                 "odometry is not valid: no pair",
                                 "odometry is not valid: no pair; its validity changed 96 times in 9 s",
                                 "odometry is not valid: no pair; its validity changed 100 times in 10 s",
                                 "odometry is not valid: no pair; its validity changed 100 times in 10 s",
                                 "odometry is not valid: no pair; its validity changed 100 times in 10 s",
                                 "odometry is not valid: no pair; its validity changed 100 times in 10 s"));

  lines.clear();
  at(std::chrono::seconds(60), valid());
  at(std::chrono::seconds(70), valid());
  EXPECT_THAT(lines, ElementsAre("odometry is valid; its validity changed 99 times in 10 s"))
      << "the final state is logged late";

  lines.clear();
  for (int i = 0; i < 10; ++i)
    at(std::chrono::seconds(300 + i), i % 2 == 0 ? invalid() : valid());
  EXPECT_EQ(lines.size(), 5U) << "after a quiet time each change is logged again";
}

}  // namespace
}  // namespace cartvo::daemon
