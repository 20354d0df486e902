#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/board/board_view.hpp"
#include "calib/model/rig.hpp"
#include "calib/solver/board_adjustment.hpp"

namespace cartvo::calib {

/// Computes a first estimate of a rig from views alone, to start the adjustment from. Each camera's focal
/// length is the one of a range that fits the corners to a flat board best, and is then adjusted together
/// with two distortion coefficients. The relative pose is that of the view that agrees best with the others.
/// Throws std::runtime_error if no focal length fits.
RigAndBoards initialCalibration(const std::vector<BoardView>& views,
                                const std::vector<Eigen::Vector2d>& board_corners, cv::Size image_size,
                                LensModel lens);

/// Estimates T_left_board for a known rig: the pose from the camera that sees more corners, adjusted to both
/// cameras. std::nullopt if it cannot be computed.
std::optional<Eigen::Isometry3d> fitBoardPose(const Rig& rig, const BoardView& view,
                                              const std::vector<Eigen::Vector2d>& board_corners,
                                              double robust_scale);

/// Robust standard deviation of the residuals per direction, px: from their median norm, for normal noise
/// with outliers.
double robustStddev(const std::vector<ViewResiduals>& residuals);

}  // namespace cartvo::calib
