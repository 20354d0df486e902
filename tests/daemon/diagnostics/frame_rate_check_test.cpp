// Sentences about frame rates that are not as configured.

#include "daemon/diagnostics/frame_rate_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cartvo::daemon {
namespace {

using testing::HasSubstr;

TEST(FrameRateCheck, NamesMeasuredAndConfiguredRates) {
  EXPECT_THAT(frameRateProblem({40'000'000, 40'100'000}, 18.0),
              HasSubstr("the cameras send 25.0 pictures a second, cameras.frame_rate says 18"));
  EXPECT_THAT(frameRateProblem({40'000'000, 55'555'555}, std::nullopt),
              HasSubstr("the left camera sends 25.0 pictures a second, the right one 18.0"));
  EXPECT_EQ(frameRateProblem({40'000'000, 40'000'000}, std::nullopt), "");
  EXPECT_EQ(frameRateProblem({40'000'000, 40'000'000}, 25.0), "");
  EXPECT_EQ(frameRateProblem({0, 40'000'000}, 18.0), "") << "not measured yet";
}

}  // namespace
}  // namespace cartvo::daemon
