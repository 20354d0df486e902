#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/board_view.hpp"
#include "calib/model/rig.hpp"

namespace cartvo::test {

/// Board poses for a good calibration: all over the image, tilted by up to 40 degrees in all directions, at
/// distances from `nearest` (m) to about twice as far. Deterministic.
std::vector<Eigen::Isometry3d> boardPoses(const calib::BoardSpec& board, double nearest, int count);

/// Simulated views of a board at these poses: the corners inside the images, with normal noise (standard
/// deviation in px).
std::vector<calib::BoardView> boardViews(const calib::Rig& rig, const calib::BoardSpec& board,
                                         const std::vector<Eigen::Isometry3d>& T_left_board, double noise,
                                         std::mt19937& random);

/// Renders an image (CV_8UC1) of a board on grey ground: 8 x 8 rays per pixel, then the blur of a lens. Edges
/// are exact if `cell` (m) divides all printed lengths.
cv::Mat renderBoard(const calib::CameraModel& camera, const Eigen::Isometry3d& T_camera_board,
                    const calib::BoardSpec& board, double cell);

}  // namespace cartvo::test
