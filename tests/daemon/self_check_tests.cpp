// Which sentences driving makes the daemon say of its cameras.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/self_check.hpp"

namespace cartvo {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

RigCheck known(Checked RigCheck::*which, double value, double deviation) {
  constexpr Checked kNothing{0.0, 1e-5};
  RigCheck rig{kNothing, kNothing, kNothing, kNothing};
  rig.*which = {value, deviation};
  return rig;
}

/// A pair of which nothing else is known.
OdometryEstimate told(const std::optional<RigCheck>& rig) {
  OdometryEstimate estimate;
  estimate.rig = rig;
  return estimate;
}

std::string sentenceFor(const RigCheck& rig) {
  SelfCheck check;
  check.note(told(rig));
  return check.sentence();
}

/// One pair in ten of a second each, with so many corners and matches in stereo.
OdometryEstimate seen(int pair, int corners, int stereo) {
  OdometryEstimate estimate;
  estimate.exposure_ns = pair * 100'000'000LL;
  estimate.counts.detected = corners;
  estimate.counts.stereo = stereo;
  return estimate;
}

/// Six seconds of it.
void drive(SelfCheck& check, int corners, int stereo) {
  for (int pair = 0; pair < 60; ++pair)
    check.note(seen(pair, corners, stereo));
}

TEST(SelfCheck, SaysNothingOfARigThatIsInOrderOrNotWatched) {
  SelfCheck check;
  check.note(told(std::nullopt));
  EXPECT_EQ(check.sentence(), "");
  check.note(told(known(&RigCheck::roll, 0.05 * kDegree, 1e-5)));
  EXPECT_EQ(check.sentence(), "");
  EXPECT_FALSE(check.takeChange());
}

TEST(SelfCheck, SaysByHowMuchTheRightCameraIsLateOrEarly) {
  EXPECT_THAT(sentenceFor(known(&RigCheck::delay, 3.1e-3, 4e-4)), HasSubstr("3.1 ± 0.4 ms later"));
  EXPECT_THAT(sentenceFor(known(&RigCheck::delay, -3.1e-3, 4e-4)), HasSubstr("3.1 ± 0.4 ms earlier"));
}

TEST(SelfCheck, SaysWhichWayTheRightCameraIsTurned) {
  EXPECT_THAT(sentenceFor(known(&RigCheck::roll, 0.31 * kDegree, 0.01 * kDegree)),
              HasSubstr("turned by +0.31 ± 0.01 deg in roll against the rig file: calibrate anew"));
  EXPECT_THAT(sentenceFor(known(&RigCheck::pitch, -0.2 * kDegree, 0.01 * kDegree)),
              HasSubstr("-0.20 ± 0.01 deg in pitch"));
  EXPECT_THAT(sentenceFor(known(&RigCheck::yaw, 0.2 * kDegree, 0.01 * kDegree)), HasSubstr("deg in yaw"));
}

TEST(SelfCheck, SaysNothingThatIsInDoubt) {
  EXPECT_EQ(sentenceFor(known(&RigCheck::delay, 3.1e-3, 1.2e-3)), "");
}

TEST(SelfCheck, TellsEachChangeOnce) {
  SelfCheck check;
  check.note(told(known(&RigCheck::delay, 3e-3, 1e-4)));
  EXPECT_TRUE(check.takeChange());
  EXPECT_FALSE(check.takeChange());
  check.note(told(known(&RigCheck::delay, 0.9e-3, 1e-4)));  // it does not come and go at the limit
  EXPECT_FALSE(check.takeChange());
  check.note(told(known(&RigCheck::delay, 0.5e-3, 1e-4)));
  EXPECT_TRUE(check.takeChange());
  EXPECT_EQ(check.sentence(), "");
}

TEST(SelfCheck, SaysThatHardlyAnyCornerIsFoundInTheOtherPicture) {
  SelfCheck check;
  drive(check, 1000, 13);
  EXPECT_THAT(check.sentence(), HasSubstr("hardly any of the left picture's corners (13 of 1000)"));
  EXPECT_LE(check.sentence().size(), 200U) << "as long as health_t has room for";
  EXPECT_TRUE(check.takeChange());
  check.note(seen(60, 1000, 400));
  EXPECT_EQ(check.sentence(), "");
  EXPECT_TRUE(check.takeChange());
}

TEST(SelfCheck, SaysNothingOfMatchesThatAreMissingForAMoment) {
  SelfCheck check;
  for (int pair = 0; pair < 200; ++pair)
    check.note(seen(pair, 1000, pair % 40 == 0 ? 300 : 0));
  EXPECT_EQ(check.sentence(), "");
}

TEST(SelfCheck, SaysNothingWhereMatchesMayBeFew) {
  SelfCheck dusk, dark;
  drive(dusk, 1000, 60);
  EXPECT_EQ(dusk.sentence(), "");
  drive(dark, 40, 0);  // there is nothing to be found
  EXPECT_EQ(dark.sentence(), "");
  SelfCheck few_features_at_dusk;
  drive(few_features_at_dusk, 200, 12);
  EXPECT_EQ(few_features_at_dusk.sentence(), "");
}

TEST(SelfCheck, APairThatWasNotLookedAtChangesNothing) {
  SelfCheck check;
  drive(check, 1000, 13);
  OdometryEstimate refused = seen(60, 0, 0);
  refused.reasons = OdometryReason::offset_uncertain;
  check.note(refused);
  EXPECT_THAT(check.sentence(), HasSubstr("13 of 1000"));
}

TEST(SelfCheck, AnAngleExplainsWhyMatchesAreMissing) {
  SelfCheck check;
  drive(check, 1000, 13);
  OdometryEstimate estimate = seen(60, 1000, 13);
  estimate.rig = known(&RigCheck::pitch, 0.3 * kDegree, 0.01 * kDegree);
  check.note(estimate);
  EXPECT_THAT(check.sentence(), HasSubstr("+0.30 ± 0.01 deg in pitch"));
  EXPECT_THAT(check.sentence(), testing::Not(HasSubstr("hardly any")));
}

TEST(SelfCheck, AnAngleThatHidesNoMatchDoesNotHideThatTheyAreMissing) {
  SelfCheck check;
  OdometryEstimate estimate = seen(0, 1000, 400);
  estimate.rig = known(&RigCheck::roll, 0.12 * kDegree, 0.01 * kDegree);
  estimate.rig->delay = {3e-3, 3e-4};
  check.note(estimate);
  EXPECT_THAT(check.sentence(), HasSubstr("+0.12"));
  drive(check, 1000, 13);  // then the lens is covered
  EXPECT_THAT(check.sentence(), StartsWith("hardly any"));
  EXPECT_LE(check.sentence().size(), 200U) << "as long as health_t has room for";
}

TEST(SelfCheck, PairsFarApartAreNotInARow) {
  SelfCheck check;
  check.note(seen(0, 1000, 13));
  check.note(seen(600, 1000, 13));
  EXPECT_EQ(check.sentence(), "");
}

}  // namespace
}  // namespace cartvo
