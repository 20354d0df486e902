// Rate limit of repeated warnings.

#include "daemon/diagnostics/log.hpp"

#include <gtest/gtest.h>

namespace cartvo::daemon {
namespace {

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
    EXPECT_NE(warnings.due(std::to_string(i), now), "");
  EXPECT_EQ(warnings.due("999", now), "");
}

}  // namespace
}  // namespace cartvo::daemon
