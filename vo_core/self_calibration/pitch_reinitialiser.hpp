#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "vo_core/self_calibration/rig_calibration_filter.hpp"
#include "vo_core/tracking/landmark_tracker.hpp"

// Recovery of the right camera's pitch after a bump.

namespace cartvo::vo {

/// Searches the right image for the landmarks' last observations, with the right camera rotated by
/// rig.expected(). Keeps existing matches of landmarks that it does not find.
using StereoMatchFunction =
    std::function<void(std::vector<Landmark>& landmarks, const RigCalibrationFilter& rig)>;

/// The newest pair of a track after stereo matching.
struct MatchedPair {
  const std::vector<Landmark>& landmarks;
  const std::vector<WindowFrame>& window;  ///< the pair is the last
  const StereoMatchFunction& match;
};

/// Reinitialises the rig's pitch by a search when almost no stereo matches are found, as after a bump against
/// the right camera. The search takes about as long as all other matching, so that it runs at intervals.
class PitchReinitialiser {
 public:
  static constexpr int kSearchInterval = 20;  ///< pairs from one search to the next

  explicit PitchReinitialiser(const StereoCamera& camera) : camera_(camera) {}

  /// Searches for the pitch if matches are missing and a search is due. Returns whether one was found, which
  /// is then set in `rig`. None is found if the rows of the matches contradict the pitch at which they were
  /// found: then they match by chance, as in images of two scenes.
  bool tryReinitialise(const MatchedPair& pair, RigCalibrationFilter& rig);

 private:
  RigCalibrationFilter refined(const MatchedPair& pair, std::vector<Landmark> landmarks,
                               RigCalibrationFilter rig) const;

  StereoCamera camera_;
  std::int64_t next_pair_ = 0;  ///< index of the first pair of the next search
};

}  // namespace cartvo::vo
