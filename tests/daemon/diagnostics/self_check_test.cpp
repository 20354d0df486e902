// Self-check messages about rig calibration, time offset and missing stereo matches.

#include "daemon/diagnostics/self_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/units.hpp"

namespace cartvo::daemon {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

vo::RigCalibrationError rigWith(vo::EstimateWithStddev vo::RigCalibrationError::*which, double value,
                                double stddev) {
  constexpr vo::EstimateWithStddev kNothing{0.0, 1e-5};
  vo::RigCalibrationError rig{kNothing, kNothing, kNothing, kNothing};
  rig.*which = {value, stddev};
  return rig;
}

/// Estimate that holds only rig calibration errors.
vo::OdometryEstimate estimateWith(const std::optional<vo::RigCalibrationError>& rig) {
  vo::OdometryEstimate estimate;
  estimate.rig = rig;
  return estimate;
}

std::string messageFor(const vo::RigCalibrationError& rig) {
  SelfCheck check;
  check.update(estimateWith(rig));
  return check.message();
}

/// Valid estimate at this time with two still regions.
vo::OdometryEstimate withStillRegions(double seconds) {
  vo::OdometryEstimate estimate;
  estimate.valid = true;
  estimate.exposure_ns = static_cast<std::int64_t>(1e9 * seconds);
  estimate.still_regions.push_back({.x = 1280, .y = 1000, .width = 1280, .height = 920});
  estimate.still_regions.push_back({.x = 0, .y = 0, .width = 300, .height = 40});
  return estimate;
}

TEST(SelfCheck, NamesStillRegionsAndHowToMaskThem) {
  constexpr std::size_t kLongestMessage = 200;  // bytes, of health_t
  SelfCheck check;
  check.update(withStillRegions(5.0));
  check.update({});  // an invalid pair says nothing
  EXPECT_EQ(check.message(), "");
  check.update(withStillRegions(25.0));
  EXPECT_TRUE(check.consumeChange());
  EXPECT_EQ(check.message(),
            "the left picture stands still at x 1280 to 2560, y 1000 to 1920 px and 1 more, not used: "
            "lettering, dirt, or the cart itself; 'cartvo calibrate mask' masks it");
  EXPECT_LE(check.message().size(), kLongestMessage);
}

TEST(SelfCheck, ForgetsStillRegionsThatMoveOn) {
  SelfCheck check;
  check.update(withStillRegions(0.0));
  vo::OdometryEstimate none = withStillRegions(19.0);
  none.still_regions.clear();
  check.update(none);
  check.update(withStillRegions(21.0));
  EXPECT_EQ(check.message(), "");
  check.update(withStillRegions(41.0));
  EXPECT_NE(check.message(), "");
  none.exposure_ns = withStillRegions(42.0).exposure_ns;
  check.update(none);
  EXPECT_TRUE(check.consumeChange());
  EXPECT_EQ(check.message(), "");
}

/// Pair number `pair` at 10 Hz with these numbers of corners and stereo matches.
vo::OdometryEstimate pairWith(int pair, int corners, int stereo) {
  vo::OdometryEstimate estimate;
  estimate.exposure_ns = pair * 100'000'000LL;
  estimate.counts.detected = corners;
  estimate.counts.stereo = stereo;
  return estimate;
}

/// Six seconds of such pairs.
void drive(SelfCheck& check, int corners, int stereo) {
  for (int pair = 0; pair < 60; ++pair)
    check.update(pairWith(pair, corners, stereo));
}

TEST(SelfCheck, IsEmptyForIntactOrUnobservedRig) {
  SelfCheck check;
  check.update(estimateWith(std::nullopt));
  EXPECT_EQ(check.message(), "");
  check.update(estimateWith(rigWith(&vo::RigCalibrationError::roll, 0.05 * kRadiansPerDegree, 1e-5)));
  EXPECT_EQ(check.message(), "");
  EXPECT_FALSE(check.consumeChange());
}

TEST(SelfCheck, ReportsTimeOffset) {
  EXPECT_THAT(messageFor(rigWith(&vo::RigCalibrationError::delay, 3.1e-3, 4e-4)),
              HasSubstr("3.1 ± 0.4 ms later"));
  EXPECT_THAT(messageFor(rigWith(&vo::RigCalibrationError::delay, -3.1e-3, 4e-4)),
              HasSubstr("3.1 ± 0.4 ms earlier"));
  EXPECT_THAT(messageFor(rigWith(&vo::RigCalibrationError::delay, 1.2e-3, 2e-5)),
              HasSubstr("1.2 ± 0.1 ms later"));
}

TEST(SelfCheck, ReportsRotationOfRightCamera) {
  EXPECT_THAT(
      messageFor(rigWith(&vo::RigCalibrationError::roll, 0.31 * kRadiansPerDegree, 0.01 * kRadiansPerDegree)),
      HasSubstr("turned by +0.31 ± 0.01 deg in roll against the rig file: calibrate again"));
  EXPECT_THAT(messageFor(rigWith(&vo::RigCalibrationError::pitch, -0.2 * kRadiansPerDegree,
                                 0.01 * kRadiansPerDegree)),
              HasSubstr("-0.20 ± 0.01 deg in pitch"));
  EXPECT_THAT(
      messageFor(rigWith(&vo::RigCalibrationError::yaw, 0.2 * kRadiansPerDegree, 0.01 * kRadiansPerDegree)),
      HasSubstr("deg in yaw"));
}

TEST(SelfCheck, ReportsNoRotationFromPairsThatAreNotValid) {
  SelfCheck check;
  vo::OdometryEstimate estimate =
      estimateWith(rigWith(&vo::RigCalibrationError::roll, 0.31 * kRadiansPerDegree, 1e-4));
  for (int pair = 0; pair < 20; ++pair)
    check.update(estimate);
  EXPECT_EQ(check.message(), "");
  estimate.valid = true;
  for (int pair = 0; pair < 20; ++pair)
    check.update(estimate);
  EXPECT_NE(check.message(), "");
}

TEST(SelfCheck, NamesAFaultUntilAPairIsValid) {
  SelfCheck check;
  vo::OdometryEstimate estimate;
  estimate.stereo_fault = vo::kStereoFaults[0].fault;
  check.update(estimate);
  estimate.stereo_fault = vo::StereoFault::none;
  check.update(estimate);
  EXPECT_EQ(check.stereoFaultMessage(), vo::kStereoFaults[0].sentence);
  estimate.valid = true;
  check.update(estimate);
  EXPECT_EQ(check.stereoFaultMessage(), "");
}

TEST(SelfCheck, IsEmptyForInsignificantError) {
  EXPECT_EQ(messageFor(rigWith(&vo::RigCalibrationError::delay, 3.1e-3, 1.2e-3)), "");
}

TEST(SelfCheck, SaysNothingOfAnEstimateThatHasFaded) {
  for (const auto which : {&vo::RigCalibrationError::delay, &vo::RigCalibrationError::pitch,
                           &vo::RigCalibrationError::yaw, &vo::RigCalibrationError::roll}) {
    SelfCheck check;
    check.update(estimateWith(rigWith(which, 7.8e-3, 1e-3)));
    EXPECT_NE(check.message(), "");
    EXPECT_TRUE(check.consumeChange());
    check.update(estimateWith(rigWith(which, 7.8e-3, 2.5e-3)));
    EXPECT_NE(check.message(), "");
    EXPECT_FALSE(check.consumeChange());
    check.update(estimateWith(rigWith(which, 7.8e-3, 2.7e-3)));
    EXPECT_EQ(check.message(), "") << "less than three standard deviations";
    EXPECT_TRUE(check.consumeChange());
    check.update(estimateWith(rigWith(which, 7.8e-3, 10.5e-3)));
    EXPECT_EQ(check.message(), "");
  }
}

TEST(SelfCheck, SignalsEachChangeOnce) {
  SelfCheck check;
  check.update(estimateWith(rigWith(&vo::RigCalibrationError::delay, 3e-3, 1e-4)));
  EXPECT_TRUE(check.consumeChange());
  EXPECT_FALSE(check.consumeChange());
  check.update(estimateWith(rigWith(&vo::RigCalibrationError::delay, 0.9e-3, 1e-4)));  // hysteresis
  EXPECT_FALSE(check.consumeChange());
  check.update(estimateWith(rigWith(&vo::RigCalibrationError::delay, 0.5e-3, 1e-4)));
  EXPECT_TRUE(check.consumeChange());
  EXPECT_EQ(check.message(), "");
}

TEST(SelfCheck, ReportsMissingStereoMatches) {
  SelfCheck check;
  drive(check, 1000, 13);
  EXPECT_THAT(check.message(), HasSubstr("hardly any corner of the left picture is found in the right one"));
  EXPECT_EQ(check.stereoFaultMessage(), check.message());
  EXPECT_LE(check.message().size(), 200U) << "limit of health_t.self_check";
  EXPECT_TRUE(check.consumeChange());
  check.update(pairWith(60, 1000, 400));
  EXPECT_EQ(check.message(), "");
  EXPECT_TRUE(check.consumeChange());
}

TEST(SelfCheck, IgnoresBriefLossOfMatches) {
  SelfCheck check;
  for (int pair = 0; pair < 200; ++pair)
    check.update(pairWith(pair, 1000, pair % 40 == 0 ? 300 : 0));
  EXPECT_EQ(check.message(), "");
}

TEST(SelfCheck, ToleratesFewMatchesAtDuskAndFewCorners) {
  SelfCheck dusk, dark;
  drive(dusk, 1000, 60);
  EXPECT_EQ(dusk.message(), "");
  drive(dark, 40, 0);  // too few corners to judge
  EXPECT_EQ(dark.message(), "");
  SelfCheck few_features_at_dusk;
  drive(few_features_at_dusk, 200, 12);
  EXPECT_EQ(few_features_at_dusk.message(), "");
}

TEST(SelfCheck, IgnoresRejectedPair) {
  SelfCheck check;
  drive(check, 1000, 13);
  vo::OdometryEstimate refused = pairWith(60, 0, 0);
  refused.reasons = vo::OdometryReason::offset_uncertain;
  check.update(refused);
  EXPECT_THAT(check.message(), StartsWith("hardly any"));
}

TEST(SelfCheck, ReportsAngleThatCausesMissingMatches) {
  SelfCheck check;
  drive(check, 1000, 13);
  vo::OdometryEstimate estimate = pairWith(60, 1000, 13);
  estimate.rig = rigWith(&vo::RigCalibrationError::pitch, 0.3 * kRadiansPerDegree, 0.01 * kRadiansPerDegree);
  check.update(estimate);
  EXPECT_THAT(check.message(), HasSubstr("+0.30 ± 0.01 deg in pitch"));
  EXPECT_THAT(check.message(), testing::Not(HasSubstr("hardly any")));
}

TEST(SelfCheck, ReportsMissingMatchesIfAngleIsTooSmallToCauseThem) {
  SelfCheck check;
  vo::OdometryEstimate estimate = pairWith(0, 1000, 400);
  estimate.rig = rigWith(&vo::RigCalibrationError::roll, 0.12 * kRadiansPerDegree, 0.01 * kRadiansPerDegree);
  estimate.rig->delay = {3e-3, 3e-4};
  check.update(estimate);
  EXPECT_THAT(check.message(), HasSubstr("+0.12"));
  drive(check, 1000, 13);  // then the lens is covered
  EXPECT_THAT(check.message(), StartsWith("hardly any"));
  EXPECT_LE(check.message().size(), 200U) << "limit of health_t.self_check";
}

TEST(SelfCheck, RequiresConsecutivePairs) {
  SelfCheck check;
  check.update(pairWith(0, 1000, 13));
  check.update(pairWith(600, 1000, 13));
  EXPECT_EQ(check.message(), "");
}

}  // namespace
}  // namespace cartvo::daemon
