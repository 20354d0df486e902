#pragma once

#include <cstdint>
#include <vector>

#include "vo_core/image/patch_search.hpp"
#include "vo_core/self_calibration/newest_pair.hpp"

// Recovery of the right camera's pitch after a bump.

namespace cartvo::vo {

/// Reinitialises the rig's pitch when almost no stereo matches are found, as after a bump against the right
/// camera. Patches that are found without a calibration show the pitch. The search takes some milliseconds,
/// so that it runs at intervals.
class PitchReinitialiser {
 public:
  /// `levels`: grey levels of both cameras' pyramids.
  PitchReinitialiser(const StereoCamera& camera, const SelfCalibrationSettings& settings, int levels);

  /// Searches for the pitch if matches of `landmarks`, the pair's, are missing and a search is due. Returns
  /// whether one was found, which is then set in `rig`. `T_right_left`: rightFromLeft(). None is found
  /// if most patches contradict it, as in images of two scenes, or if it is the one that the matches were
  /// searched with: then the scene hides them.
  bool tryReinitialise(const NewestPair& pair, const Eigen::Isometry3d& T_right_left,
                       const std::vector<Landmark>& landmarks, RigCalibration& rig);

 private:
  SelfCalibrationSettings settings_;
  PatchSearch search_;
  std::int64_t next_pair_ = 0;  ///< index of the first pair of the next search
};

}  // namespace cartvo::vo
