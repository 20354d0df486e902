// Tests of the interval between searches for the pitch.
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

constexpr StereoCamera kCamera{480.0, 340.0, 210.0, 0.115, 680, 420};
constexpr int kInterval = PitchReinitialiser::kSearchInterval;

/// Whether the pitch is searched for at a pair whose landmarks have no stereo match.
bool searches(PitchReinitialiser& reinitialiser, int index) {
  std::vector<Landmark> landmarks(100);
  for (Landmark& landmark : landmarks)
    landmark.observations.resize(1);
  std::vector<WindowFrame> window(1);
  window.back().index = index;
  bool searched = false;
  RigCalibrationFilter rig;
  const StereoMatchFunction match = [&](std::vector<Landmark>&, const RigCalibrationFilter&) {
    searched = true;
  };
  EXPECT_FALSE(reinitialiser.tryReinitialise({landmarks, window, match}, rig));
  return searched;
}

TEST(PitchReinitialiser, SearchesAtIntervals) {
  PitchReinitialiser reinitialiser(kCamera);
  for (int i = 0; i < 3 * kInterval; ++i)
    EXPECT_EQ(searches(reinitialiser, i), i % kInterval == 0) << i;
}

TEST(PitchReinitialiser, SearchesOncePerPairForTwoTracks) {
  PitchReinitialiser reinitialiser(kCamera);
  for (int i = 0; i < 2 * kInterval; ++i) {
    EXPECT_EQ(searches(reinitialiser, i), i % kInterval == 0) << i;
    EXPECT_FALSE(searches(reinitialiser, i)) << i;
  }
}

}  // namespace
}  // namespace cartvo::vo
