#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "vo_core/self_calibration/rig_calibration.hpp"
#include "vo_core/tracking/landmark_tracker.hpp"

// Stereo matching of the newest pair with the right camera rotated by the estimated calibration error.

namespace cartvo::vo {

/// The newest pair of a track and the tracker that matches its landmarks.
struct NewestPair {
  const LandmarkTracker& tracker;
  const StereoCamera& camera;
  const RowTiming& timing;
  const ImagePyramid& left;
  const ImagePyramid& right;
  const std::vector<WindowFrame>& window;  ///< the pair is the last
};

/// Searches the right image for the landmarks' last observations, with the right camera rotated by
/// rig.expected(). `T_right_left`: rightFromLeft(), from the rig file without correction.
void matchStereoRotated(const NewestPair& pair, const Eigen::Isometry3d& T_right_left,
                        const RigCalibration& rig, std::vector<Landmark>& landmarks);

}  // namespace cartvo::vo
