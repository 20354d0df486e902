#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calib/board_view.hpp"
#include "calib/rig.hpp"

namespace cartvo {

/// T_camera_board of a board of which a camera sees these corners: the homography from board to rays, split
/// into rotation and translation (Z. Zhang, "A flexible new technique for camera calibration", 2000). Works
/// on rays, not pixels, so that any lens will do. Nothing with less than four corners, or if they lie on a
/// line.
std::optional<Eigen::Isometry3d> boardPose(const CameraModel& camera, const std::vector<SeenCorner>& seen,
                                           const std::vector<Eigen::Vector2d>& board_corners);

}  // namespace cartvo
