// Sentences about frame rates that are not as configured.

#include "daemon/diagnostics/frame_rate_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cartvo::daemon {
namespace {

using testing::HasSubstr;

/// Measured alike by exposures and arrivals.
std::string problemOf(std::int64_t left_ns, std::int64_t right_ns, std::optional<double> configured) {
  return frameRateProblem({{left_ns, right_ns}, {left_ns, right_ns}}, configured);
}

TEST(FrameRateCheck, NamesMeasuredAndConfiguredRates) {
  EXPECT_THAT(problemOf(40'000'000, 40'100'000, 18.0),
              HasSubstr("the cameras send 25.0 pictures a second, cameras.frame_rate says 18"));
  EXPECT_THAT(problemOf(40'000'000, 55'555'555, std::nullopt),
              HasSubstr("the left camera sends 25.0 pictures a second, the right one 18.0"));
  EXPECT_EQ(problemOf(40'000'000, 40'000'000, std::nullopt), "");
  EXPECT_EQ(problemOf(40'000'000, 40'000'000, 25.0), "");
  EXPECT_EQ(problemOf(0, 40'000'000, 18.0), "") << "not measured yet";
}

TEST(FrameRateCheck, IsSilentWhereExposuresAndArrivalsDoNotBothDiffer) {
  EXPECT_EQ(frameRateProblem({{33'333'333, 33'333'333}, {55'555'555, 55'555'555}}, 18.0), "")
      << "time stamps rounded to 1/30 s";
  EXPECT_EQ(frameRateProblem({{55'555'555, 55'555'555}, {80'000'000, 55'555'555}}, 18.0), "")
      << "a third of the left camera's pictures are lost";
}

}  // namespace
}  // namespace cartvo::daemon
