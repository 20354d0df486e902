#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/board_adjustment.hpp"
#include "calib/board_view.hpp"
#include "calib/rig.hpp"

namespace cartvo {

/// A first estimate of a rig from views alone, good enough to adjust from: each camera's focal length is the
/// one of a range under which its boards look flat, then it is adjusted with two coefficients of distortion;
/// the relative pose is that of the view which agrees best with the others. Throws std::runtime_error if no
/// focal length makes the views boards.
RigAndBoards calibrationStart(const std::vector<BoardView>& views,
                              const std::vector<Eigen::Vector2d>& board_corners, cv::Size image_size,
                              LensModel lens);

/// Where a board stands before a known rig: the pose from whichever camera sees more of it, adjusted to both.
/// Nothing if it cannot be found.
std::optional<Eigen::Isometry3d> poseBefore(const Rig& rig, const BoardView& view,
                                            const std::vector<Eigen::Vector2d>& board_corners,
                                            double robust_scale);

/// The standard deviation in each direction of residuals that scatter normally but for some outliers, px.
double robustDeviation(const std::vector<ViewResiduals>& residuals);

}  // namespace cartvo
