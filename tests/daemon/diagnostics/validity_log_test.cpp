// Log lines about changes of validity and their rate limit.

#include "daemon/diagnostics/validity_log.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cartvo::daemon {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

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
