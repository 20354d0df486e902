// Reinitialisation of the rig's pitch when stereo matches are missing.
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"

#include <cmath>
#include <utility>

#include "vo_core/estimation/window_problems.hpp"
#include "vo_core/self_calibration/pitch_search.hpp"

namespace cartvo::vo {

bool PitchReinitialiser::tryReinitialise(const MatchedPair& pair, RigCalibrationFilter& rig) {
  const std::int64_t index = pair.window.back().index;
  if (index < next_pair_ || !hasFewMatches(pair.landmarks)) return false;
  next_pair_ = index + kSearchInterval;
  std::vector<Landmark> landmarks = pair.landmarks;
  const auto pitch =
      findPitch(landmarks, camera_.focal_length, [&](std::vector<Landmark>& trial, double trial_pitch) {
        RigCalibrationFilter trial_rig = rig;
        trial_rig.reinitialisePitch(trial_pitch);
        pair.match(trial, trial_rig);
      });
  if (!pitch) return false;
  RigCalibrationFilter found = rig;
  found.reinitialisePitch(*pitch);
  const RigCalibrationFilter refined_rig = refined(pair, std::move(landmarks), found);
  const double change = refined_rig.error().pitch.value - found.error().pitch.value;
  if (!(std::abs(change) <= pitchSearchRange(camera_.focal_length))) return false;
  rig = refined_rig;
  return true;
}

/// Refines the pitch, known to a step of the search, from the rows of the matches at it: in the first round
/// of those near enough, in the second of all.
RigCalibrationFilter PitchReinitialiser::refined(const MatchedPair& pair, std::vector<Landmark> landmarks,
                                                 RigCalibrationFilter rig) const {
  for (int round = 0; round < 2; ++round) {
    discardLastStereo(landmarks);
    pair.match(landmarks, rig);
    rig.reinitialisePitch(buildNewestPairProblem(landmarks, pair.window, camera_));
  }
  return rig;
}

}  // namespace cartvo::vo
