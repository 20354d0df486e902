#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "vo_core/landmark_tracker.hpp"
#include "vo_core/rig_monitor.hpp"

namespace cartvo {

/// Looks for landmarks' last sightings in the right image, turned as a monitor expects. Leaves those alone
/// that have a match already and find none.
using MatchBy = std::function<void(std::vector<Landmark>& landmarks, const RigMonitor& rig)>;

/// The newest pair of a track, its landmarks matched in stereo as far as they were found.
struct MatchedPair {
  const std::vector<Landmark>& landmarks;
  const std::vector<WindowFrame>& window;  ///< the pair is the last
  const MatchBy& match;
};

/// Where hardly a match is found, looks now and then whether the right camera has been bumped up or down:
/// that takes about as long as all other matching.
class PitchSuspicion {
 public:
  explicit PitchSuspicion(const StereoCamera& camera) : camera_(camera) {}

  /// True if it has, by a pitch that was not known; `rig` knows it then.
  bool take(const MatchedPair& pair, RigMonitor& rig);

 private:
  void refine(const MatchedPair& pair, std::vector<Landmark> sought, RigMonitor& rig) const;

  StereoCamera camera_;
  std::int64_t next_pair_ = 0;  ///< index of the first that may be looked at
};

}  // namespace cartvo
