#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calib/board/board_view.hpp"
#include "calib/model/rig.hpp"

namespace cartvo::calib {

/// Computes T_camera_board from the corners in one image: the homography from the board to the rays,
/// decomposed into rotation and translation (Z. Zhang, "A flexible new technique for camera calibration",
/// 2000). It uses rays instead of pixels, which suits every lens. std::nullopt with fewer than four corners
/// or if they are collinear.
std::optional<Eigen::Isometry3d> boardPose(const CameraModel& camera, const std::vector<SeenCorner>& seen,
                                           const std::vector<Eigen::Vector2d>& board_corners);

}  // namespace cartvo::calib
