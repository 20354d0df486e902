#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/board_spec.hpp"

namespace cartvo {

/// What is black on a board, in board axes (see board_spec.hpp), m. The rectangles touch but do not overlap;
/// all else is white.
std::vector<cv::Rect2d> boardBlackRectangles(const BoardSpec& board);

}  // namespace cartvo
