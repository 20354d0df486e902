// Which sentences driving makes the daemon say of its cameras.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/self_check.hpp"

namespace cartvo {
namespace {

using testing::HasSubstr;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

RigCheck known(Checked RigCheck::*which, double value, double deviation) {
  constexpr Checked kNothing{0.0, 1e-5};
  RigCheck rig{kNothing, kNothing, kNothing, kNothing};
  rig.*which = {value, deviation};
  return rig;
}

std::string sentenceFor(const RigCheck& rig) {
  SelfCheck check;
  check.note(rig);
  return check.sentence();
}

TEST(SelfCheck, SaysNothingOfARigThatIsInOrderOrNotWatched) {
  SelfCheck check;
  check.note(std::nullopt);
  EXPECT_EQ(check.sentence(), "");
  check.note(known(&RigCheck::roll, 0.05 * kDegree, 1e-5));
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
  check.note(known(&RigCheck::delay, 3e-3, 1e-4));
  EXPECT_TRUE(check.takeChange());
  EXPECT_FALSE(check.takeChange());
  check.note(known(&RigCheck::delay, 0.9e-3, 1e-4));  // it does not come and go at the limit
  EXPECT_FALSE(check.takeChange());
  check.note(known(&RigCheck::delay, 0.5e-3, 1e-4));
  EXPECT_TRUE(check.takeChange());
  EXPECT_EQ(check.sentence(), "");
}

}  // namespace
}  // namespace cartvo
