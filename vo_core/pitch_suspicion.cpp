// A bumped right camera, suspected where matches are missing.
#include "vo_core/pitch_suspicion.hpp"

#include <utility>

#include "vo_core/pitch_search.hpp"
#include "vo_core/window_problems.hpp"

namespace cartvo {
namespace {

constexpr int kPairsBetween = 20;  // from one look to the next

}  // namespace

bool PitchSuspicion::take(const MatchedPair& pair, RigMonitor& rig) {
  const std::int64_t index = pair.window.back().index;
  if (index < next_pair_ || !hardlyMatched(pair.landmarks)) return false;
  next_pair_ = index + kPairsBetween;
  std::vector<Landmark> sought = pair.landmarks;
  const auto pitch = findPitch(sought, camera_.focal_length, [&](std::vector<Landmark>& tried, double by) {
    RigMonitor bumped = rig;
    bumped.suspectPitch(by);
    pair.match(tried, bumped);
  });
  if (!pitch) return false;
  rig.suspectPitch(*pitch);
  refine(pair, std::move(sought), rig);
  return true;
}

/// The pitch found is as rough as the steps it was looked for in. The rows of the matches that it brings tell
/// the rest: at first of those that lie near enough, then of all.
void PitchSuspicion::refine(const MatchedPair& pair, std::vector<Landmark> sought, RigMonitor& rig) const {
  for (int round = 0; round < 2; ++round) {
    forgetLastStereo(sought);
    pair.match(sought, rig);
    rig.suspectPitch(matchesAlone(sought, pair.window, camera_));
  }
}

}  // namespace cartvo
