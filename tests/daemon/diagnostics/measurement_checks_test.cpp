// Checks of what cartvod measures against its configuration: frame rates and readouts.

#include "daemon/diagnostics/measurement_checks.hpp"

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

std::string messageFor(const StatedReadouts& stated, const vo::ReadoutEstimates& estimates) {
  ReadoutCheck check(stated);
  const bool has_changed = check.update(estimates);
  EXPECT_EQ(has_changed, !check.message().empty());
  EXPECT_LE(check.message().size(), 200U);
  return check.message();
}

TEST(ReadoutCheck, AcceptsReadoutsOfTheRig) {
  EXPECT_EQ(messageFor({0.032, 0.032}, {{0.0324, 1e-5}, {0.0319, 1e-5}}), "") << "below 0.5 ms";
  EXPECT_EQ(messageFor({0.032, 0.032}, {{0.034, 1e-3}, {0.03, 1e-3}}), "") << "not significant";
  EXPECT_EQ(messageFor({}, {{0.032, 1e-4}, {-0.0322, 1e-4}}), "") << "one camera is upside down";
}

TEST(ReadoutCheck, ReportsAReadoutThatIsNotTheRigs) {
  EXPECT_THAT(messageFor({0.032, 0.032}, {{0.032, 1e-4}, {0.0384, 1e-4}}),
              HasSubstr("the right camera's readout is 38.4 ± 0.1 ms, not 32.0 ms as the rig says"));
  EXPECT_THAT(messageFor({0.032, {}}, {{-0.032, 1e-4}, {0.032, 1e-4}}), HasSubstr("the left camera's"));
}

TEST(ReadoutCheck, ReportsUnlikeLineFrequencies) {
  EXPECT_THAT(messageFor({}, {{0.032, 2e-4}, {0.0384, 2e-4}}),
              HasSubstr("the cameras' line frequency settings differ (50 Hz / 60 Hz)"));
  EXPECT_THAT(messageFor({}, {{0.032, 2e-4}, {0.025, 2e-4}}), HasSubstr("the cameras' readouts differ"));
  EXPECT_THAT(messageFor({}, {{0.032, 2e-4}, {0.0, 2e-4}}), HasSubstr("the cameras' readouts differ"));
}

TEST(ReadoutCheck, AcceptsUnlikeReadoutsThatTheRigStates) {
  EXPECT_EQ(messageFor({0.032, 0.0384}, {{0.032, 2e-4}, {0.0384, 2e-4}}), "");
}

TEST(ReadoutCheck, ReportsADifferenceUntilItIsClearlySmaller) {
  ReadoutCheck check({0.032, 0.032});
  EXPECT_TRUE(check.update({{0.0326, 1e-5}, {0.032, 1e-5}}));
  EXPECT_FALSE(check.update({{0.0324, 1e-5}, {0.032, 1e-5}}));
  EXPECT_TRUE(check.update({{0.0323, 1e-5}, {0.032, 1e-5}}));
  EXPECT_EQ(check.message(), "");
}

}  // namespace
}  // namespace cartvo::daemon
