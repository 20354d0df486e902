// Tests of the interval between searches for the pitch, and of what they refuse.
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"

#include <cmath>
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

constexpr double kPitch = 0.008;  // rad

/// Searches with matches only near kPitch, whose rows in the right image are lower by
/// -`row_offset` px. Returns the pitch that is then set, rad.
double pitchFoundByRows(double row_offset) {
  std::vector<Landmark> landmarks;
  for (int i = 0; i < 100; ++i) {
    Landmark& landmark = landmarks.emplace_back();
    landmark.observations.resize(1);
    landmark.observations.back().left = {50.0 + 6.0 * i, 30.0 + std::fmod(37.0 * i, 360.0)};
    landmark.inverse_depth = 0.1;
    landmark.information = 1e4;
  }
  std::vector<WindowFrame> window(1);
  window.back().index = 0;
  RigCalibrationFilter rig;
  const StereoMatchFunction match = [&](std::vector<Landmark>& wanted, const RigCalibrationFilter& trial) {
    if (trial.error().pitch.value < 0.5 * kPitch) return;
    for (Landmark& landmark : wanted) {
      Observation& seen = landmark.observations.back();
      seen.stereo = true;
      seen.stereo_offset = {0.1 * kCamera.focal_length * kCamera.baseline, row_offset};
    }
  };
  PitchReinitialiser(kCamera).tryReinitialise({landmarks, window, match}, rig);
  return rig.error().pitch.value;
}

TEST(PitchReinitialiser, RefusesAPitchThatItsMatchesContradict) {
  EXPECT_NEAR(pitchFoundByRows(-kPitch * kCamera.focal_length), kPitch, 0.1 * kPitch);
  for (const double row_offset : {-40.0, 4.0, 40.0})
    EXPECT_EQ(pitchFoundByRows(row_offset), 0.0) << row_offset;
}

}  // namespace
}  // namespace cartvo::vo
