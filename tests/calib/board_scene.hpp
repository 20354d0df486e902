#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board_spec.hpp"
#include "calib/board_view.hpp"
#include "calib/rig.hpp"

namespace cartvo::test {

/// Board poses before a rig as a careful person shows them: all over the image, tilted by up to 40 degrees to
/// all sides, from `nearest` to twice as far (m). The same each time.
std::vector<Eigen::Isometry3d> boardPoses(const BoardSpec& board, double nearest, int count);

/// What a rig sees of a board at these poses: the corners that fall into the images, moved by normal noise
/// (px).
std::vector<BoardView> boardViews(const Rig& rig, const BoardSpec& board,
                                  const std::vector<Eigen::Isometry3d>& T_left_board, double noise,
                                  std::mt19937& random);

/// An image (CV_8UC1) of a board on grey ground: 8 x 8 rays a pixel, then the blur of a lens. Edges lie where
/// they should if `cell` (m) divides all that is printed.
cv::Mat renderBoard(const CameraModel& camera, const Eigen::Isometry3d& T_camera_board,
                    const BoardSpec& board, double cell);

}  // namespace cartvo::test
