#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/board_view.hpp"

namespace cartvo::calib {

/// Detects the corners of a board in a grey image (CV_8UC1), sorted by id, with subpixel accuracy. A
/// chessboard must be visible completely; a board with markers may be visible in part. Empty if no board is
/// found.
std::vector<SeenCorner> detectBoard(const cv::Mat& grey, const BoardSpec& board);

/// Describes a board in the image that is not the given one: "a chessboard of 8x6 inner corners", "a marker
/// with the number 40". Empty if there is none.
std::string describeOtherBoard(const cv::Mat& grey, const BoardSpec& board);

}  // namespace cartvo::calib
