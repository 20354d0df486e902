#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "vo_core/landmark_tracker.hpp"
#include "vo_core/rig_monitor.hpp"

namespace cartvo {

/// A track's newest pair and what its landmarks are matched in stereo by.
struct NewestPair {
  const LandmarkTracker& tracker;
  const ImagePyramid& left;
  const ImagePyramid& right;
  const std::vector<WindowFrame>& window;  ///< the pair is the last
};

/// Looks for the landmarks' last sightings in the pair's right image, where the right camera is turned as
/// `rig` expects. `T_right_left`: newestRightFromLeft()'s, by the rig file alone.
void matchTurned(const NewestPair& pair, const Eigen::Isometry3d& T_right_left, const RigMonitor& rig,
                 std::vector<Landmark>& landmarks);

}  // namespace cartvo
