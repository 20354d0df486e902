#pragma once

#include <cstddef>
#include <vector>

#include "vo_core/estimation/pose_search.hpp"
#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/tracking/landmark.hpp"
#include "vo_core/tracking/window_frame.hpp"

// Conversion of a window of pairs and its landmarks to problems of the pose search. Output lists reserve the
// capacity of the list of landmarks, so that the steady state allocates nothing.

namespace cartvo::vo {

/// Fills `points` with the landmarks that have a depth and `chosen` with their indices. Their last
/// observations must be in the current pair. `window` has the anchors and may end before the current pair; a
/// landmark whose anchor is not in the window is left out. Their weights are bounded for each cell of the
/// image.
void toPosePoints(const std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                  const StereoCamera& camera, std::vector<PosePoint>& points,
                  std::vector<std::size_t>& chosen);

/// Reduces points of toPosePoints() to the landmarks with a stereo match in the current pair and replaces
/// `left` by the right position, corrected by `rig`: a pose search with them finds the pose of the right
/// camera.
void toRightCameraPoints(const std::vector<Landmark>& landmarks, const std::vector<std::size_t>& chosen,
                         const StereoCamera& camera, const RigCorrection& rig,
                         std::vector<PosePoint>& points);

}  // namespace cartvo::vo
