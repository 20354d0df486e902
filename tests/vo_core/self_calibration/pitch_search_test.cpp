// Tests of the search for the pitch by day and in the dark.
#include "vo_core/self_calibration/pitch_search.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

constexpr double kFocalLength = 480.0;
constexpr double kNear = 1.2 / kFocalLength;  // rad, range of the search for matches
constexpr std::size_t kCount = 1000;

/// Landmarks, every `nth` of which is matched at zero pitch.
std::vector<Landmark> landmarks(std::size_t nth) {
  std::vector<Landmark> made(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    made[i].observations.resize(1);
    made[i].observations[0].stereo = i % nth == 1;
    made[i].observations[0].left.x() = static_cast<double>(i);
  }
  return made;
}

/// Right camera at `pitch`: every `nth` landmark finds a match near it, and every `by_chance`-th at any
/// pitch.
MatchAtPitch camera(double pitch, int nth, int by_chance) {
  return [=](std::vector<Landmark>& wanted, double tried) {
    for (Landmark& landmark : wanted) {
      Observation& last = landmark.observations.back();
      const int i = static_cast<int>(last.left.x());
      if (i % by_chance == 0 || (std::abs(tried - pitch) < kNear && i % nth == 0)) last.stereo = true;
    }
  };
}

TEST(PitchSearch, FindsThePitchByDay) {
  const auto found = findPitch(landmarks(51), kFocalLength, camera(-0.006, 1, 51));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(*found, -0.006, kNear);
}

TEST(PitchSearch, FindsThePitchInTheDarkFromFewMatches) {
  for (const double pitch : {-0.009, -0.0052, 0.003, 0.0052}) {
    const auto found = findPitch(landmarks(81), kFocalLength, camera(pitch, 19, 97));
    ASSERT_TRUE(found.has_value()) << pitch;
    EXPECT_NEAR(*found, pitch, kNear);
  }
}

TEST(PitchSearch, FindsNothingFromMatchesByChance) {
  EXPECT_FALSE(findPitch(landmarks(51), kFocalLength, camera(1.0, 1, 51)).has_value());
  EXPECT_FALSE(findPitch(landmarks(11), kFocalLength, camera(1.0, 1, 21)).has_value());
}

TEST(PitchSearch, FindsNothingInTheDarkWithACorrectRig) {
  EXPECT_FALSE(findPitch(landmarks(19), kFocalLength, camera(0.003, 41, 97)).has_value());
}

}  // namespace
}  // namespace cartvo::vo
