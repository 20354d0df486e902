// How often a bumped right camera is looked for.
#include "vo_core/pitch_suspicion.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

constexpr StereoCamera kCamera{480.0, 340.0, 210.0, 0.115, 680, 420};
constexpr int kPairsBetween = 20;

/// Whether, given landmarks none of which is ever matched, the right camera is looked for at that pair.
bool looks(PitchSuspicion& suspicion, int index) {
  std::vector<Landmark> landmarks(100);
  for (Landmark& landmark : landmarks)
    landmark.sightings.resize(1);
  std::vector<WindowFrame> window(1);
  window.back().index = index;
  bool looked = false;
  RigMonitor rig;
  const MatchBy match = [&](std::vector<Landmark>&, const RigMonitor&) { looked = true; };
  EXPECT_FALSE(suspicion.take({landmarks, window, match}, rig));
  return looked;
}

TEST(PitchSuspicion, LooksAtEachTwentiethPair) {
  PitchSuspicion suspicion(kCamera);
  for (int i = 0; i < 3 * kPairsBetween; ++i)
    EXPECT_EQ(looks(suspicion, i), i % kPairsBetween == 0) << i;
}

TEST(PitchSuspicion, LooksAtAPairOnceThoughTwoTracksTakeIt) {
  PitchSuspicion suspicion(kCamera);
  for (int i = 0; i < 2 * kPairsBetween; ++i) {
    EXPECT_EQ(looks(suspicion, i), i % kPairsBetween == 0) << i;
    EXPECT_FALSE(looks(suspicion, i)) << i;
  }
}

}  // namespace
}  // namespace cartvo
