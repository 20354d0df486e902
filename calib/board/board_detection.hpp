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

/// Gives the corners of a view the same numbering in both images. Only boards that look the same upside down
/// need it, see detectChessboard.
void matchNumbering(const BoardSpec& board, BoardView& view);

/// Describes a board in the image that is not the given one: "a chessboard of 8x6 inner corners", "a marker
/// with the number 40". Empty if there is none.
std::string describeOtherBoard(const cv::Mat& grey, const BoardSpec& board);

/// Describes a chessboard in the image that has more corners than the given one, which may be a part of it:
/// "a chessboard of 9x6 inner corners". Empty if there is none, and for other kinds of boards.
std::string describeLargerBoard(const cv::Mat& grey, const BoardSpec& board);

}  // namespace cartvo::calib
