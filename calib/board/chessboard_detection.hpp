#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/board_view.hpp"

namespace cartvo::calib {

/// Detects the inner corners of a chessboard that is completely visible; empty otherwise. The numbering is
/// the same in both cameras: the top left square of a board with one odd and one even side is its black
/// corner. Other boards look the same upside down; for them the direction of the rows is the one that points
/// most to the right in the image.
std::vector<SeenCorner> detectChessboard(const cv::Mat& grey, const Chessboard& board);

/// Describes the chessboard in an image, whatever its size: "a chessboard of 8x6 inner corners". Empty if
/// there is none.
std::string describeChessboard(const cv::Mat& grey);

}  // namespace cartvo::calib
