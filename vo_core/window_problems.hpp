#pragma once

#include <cstddef>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/landmark_tracker.hpp"
#include "vo_core/pose_search.hpp"

// A window of pairs and its landmarks, as the estimators are asked about them. Lists that are filled get room
// for as many as there is room for landmarks, so that none grows once that does not.

namespace cartvo {

/// Times in s since the oldest.
TimedPoses timedPoses(const std::vector<WindowFrame>& window);

/// The landmarks whose depth is known and whose last sighting is of the current pair; `window` has their
/// hosts and may end before that pair. `chosen`: which landmarks they are. Both are overwritten; their memory
/// is used again.
void takePoints(const std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                const StereoCamera& camera, std::vector<PosePoint>& points, std::vector<std::size_t>& chosen);

/// Of such points those that the current pair sees in its right image too, where that sees them, corrected by
/// `rig`: by them it is the right camera whose pose is sought.
void seeByRight(const std::vector<Landmark>& landmarks, const std::vector<std::size_t>& chosen,
                const StereoCamera& camera, const RigCorrection& rig, std::vector<PosePoint>& points);

/// The landmarks seen by more than one pair, their right pixels corrected by `rig`; `window` ends with the
/// current pair. `chosen`: which landmarks they are. Both are overwritten; their memory is used again.
void takeLandmarks(const std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                   const StereoCamera& camera, const RigCorrection& rig, std::vector<BundleLandmark>& items,
                   std::vector<std::size_t>& chosen);

/// The newest pair's stereo matches by themselves, hosted there, each at the depth that its own disparity
/// tells: what rows are left over does not depend on a window that may not have come about yet.
BundleProblem matchesAlone(const std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                           const StereoCamera& camera);

/// Whether an adjusted landmark's depth has come from what was seen, rather than from what is expected of any
/// landmark.
bool tellsDepth(const BundleLandmark& adjusted);

}  // namespace cartvo
