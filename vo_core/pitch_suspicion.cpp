// A bumped right camera, suspected where matches are missing.
#include "vo_core/pitch_suspicion.hpp"

#include <cmath>
#include <utility>

#include "vo_core/pitch_search.hpp"
#include "vo_core/window_problems.hpp"

namespace cartvo {
namespace {

constexpr int kPairsBetween = 20;  // from one look to the next

}  // namespace

bool PitchSuspicion::take(const MatchedPair& pair, RigMonitor& rig) {
  const std::int64_t index = pair.window.back().index;
  if (refinement_ == RigRefinement::off || index < next_pair_ || !hardlyMatched(pair.landmarks)) return false;
  next_pair_ = index + kPairsBetween;
  std::vector<Landmark> sought = pair.landmarks;
  if (knownExplains(pair, rig, sought)) return false;
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

/// Where nothing is corrected, the pair was matched as if nothing was known of the rig. Whether what is known
/// brings the matches that are missing; `sought` has been matched by it then.
bool PitchSuspicion::knownExplains(const MatchedPair& pair, RigMonitor& rig,
                                   std::vector<Landmark>& sought) const {
  const RigCorrection known = rig.expected();
  if (refinement_ == RigRefinement::correct || std::hypot(known.pitch, known.roll) == 0.0) return false;
  forgetStereoAndDepth(sought);
  pair.match(sought, rig);
  if (!hardlyMatched(sought)) return true;
  if (!clearlyMoreMatched(sought, pair.landmarks)) return false;
  // As it is dark, no track begins without them, and nothing else would hear where the camera looks now.
  if (pair.window.size() == 1) rig.suspectPitch(matchesAlone(sought, pair.window, camera_));
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
