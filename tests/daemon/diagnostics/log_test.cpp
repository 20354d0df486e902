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

}  // namespace
}  // namespace cartvo::daemon
