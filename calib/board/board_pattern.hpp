#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/board/board_spec.hpp"

namespace cartvo::calib {

/// The black rectangles of a printed calibration board, in board axes (see board_spec.hpp), m. They may touch
/// but do not overlap.
std::vector<cv::Rect2d> boardBlackRectangles(const BoardSpec& board);

}  // namespace cartvo::calib
