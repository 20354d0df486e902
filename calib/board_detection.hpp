#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board_spec.hpp"
#include "calib/board_view.hpp"

namespace cartvo {

/// The corners of a board in a grey image (CV_8UC1), by rising id, to a fraction of a pixel. A chessboard is
/// seen whole or not at all; of boards with markers any part will do. Empty where there is no board.
std::vector<SeenCorner> detectBoard(const cv::Mat& grey, const BoardSpec& board);

/// What an image shows that the board cannot: "a chessboard of 8x6 inner corners", "a tag with the number
/// 40". Empty if there is nothing of the kind.
std::string otherBoardSeen(const cv::Mat& grey, const BoardSpec& board);

}  // namespace cartvo
