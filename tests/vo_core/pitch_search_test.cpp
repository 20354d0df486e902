// At which pitch of the right camera enough landmarks find a match, by day and in the dark.
#include "vo_core/pitch_search.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

constexpr double kFocalLength = 480.0;
constexpr double kNear = 1.2 / kFocalLength;  // rad, at which matches are found
constexpr std::size_t kCount = 1000;

/// Each `nth` is matched as the rig file says.
std::vector<Landmark> landmarks(std::size_t nth) {
  std::vector<Landmark> made(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    made[i].sightings.resize(1);
    made[i].sightings[0].stereo = i % nth == 1;
    made[i].sightings[0].left.x() = static_cast<double>(i);
  }
  return made;
}

/// The right camera looks up by so much, where each `nth` finds a match; by chance each `by_chance`th does
/// anywhere.
MatchAtPitch camera(double pitch, int nth, int by_chance) {
  return [=](std::vector<Landmark>& wanted, double tried) {
    for (Landmark& landmark : wanted) {
      Sighting& last = landmark.sightings.back();
      const int i = static_cast<int>(last.left.x());
      if (i % by_chance == 0 || (std::abs(tried - pitch) < kNear && i % nth == 0)) last.stereo = true;
    }
  };
}

TEST(PitchSearch, FindsByDayWhereNearlyAllMatch) {
  const auto found = findPitch(landmarks(51), kFocalLength, camera(-0.006, 1, 51));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(*found, -0.006, kNear);
}

TEST(PitchSearch, FindsInTheDarkWhereFewMatchButFarMoreThanByChance) {
  for (const double pitch : {-0.009, -0.0052, 0.003, 0.0052}) {
    const auto found = findPitch(landmarks(81), kFocalLength, camera(pitch, 19, 97));
    ASSERT_TRUE(found.has_value()) << pitch;
    EXPECT_NEAR(*found, pitch, kNear);
  }
}

TEST(PitchSearch, FindsNothingWhereAllMatchesAreByChance) {
  EXPECT_FALSE(findPitch(landmarks(51), kFocalLength, camera(1.0, 1, 51)).has_value());
  EXPECT_FALSE(findPitch(landmarks(11), kFocalLength, camera(1.0, 1, 21)).has_value());
}

TEST(PitchSearch, FindsNothingInTheDarkWithARigInOrder) {
  EXPECT_FALSE(findPitch(landmarks(19), kFocalLength, camera(0.003, 41, 97)).has_value());
}

}  // namespace
}  // namespace cartvo
