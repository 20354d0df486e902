#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board_spec.hpp"
#include "calib/board_view.hpp"

namespace cartvo {

/// The inner corners of a chessboard that is seen whole; empty otherwise. Both cameras must number them
/// alike: the top left square of a board with an odd and an even side is its black corner; other boards look
/// the same upside down, and there the row that points most to the right in the image is the first direction.
std::vector<SeenCorner> detectChessboard(const cv::Mat& grey, const Chessboard& board);

/// What chessboard an image shows, of any size: "a chessboard of 8x6 inner corners"; empty if none.
std::string chessboardSeen(const cv::Mat& grey);

}  // namespace cartvo
