#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/board_view.hpp"

namespace cartvo::calib {

/// Detects the inner corners of a chessboard that is completely visible; empty otherwise. The numbering is
/// the same in both cameras: the top left square of a board with one odd and one even side is its black
/// corner. Other boards look the same upside down; for them the direction of the rows is the one that points
/// most to the right and a little down in the image, and matchNumbering makes the numbering the same.
std::vector<SeenCorner> detectChessboard(const cv::Mat& grey, const Chessboard& board);

/// Renumbers the corners of the right image so that rows run as in the left one, for a board that looks the
/// same after a half turn, or a quarter turn if it is square. The cameras may be turned against each other
/// about their axes by less than 90 (45) degrees.
void matchNumbering(const Chessboard& board, const std::vector<SeenCorner>& left,
                    std::vector<SeenCorner>& right);

/// Number of inner corners along and across the chessboard in an image, whatever its size; nothing if there
/// is none.
std::optional<cv::Size> chessboardSize(const cv::Mat& grey);

}  // namespace cartvo::calib
