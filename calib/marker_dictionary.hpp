#pragma once

#include <opencv2/aruco.hpp>

#include "calib/board_spec.hpp"

namespace cartvo {

/// How the markers of a board are coded, for drawing and detecting them.
struct MarkerDictionary {
  cv::Ptr<cv::aruco::Dictionary> dictionary;  ///< holds at least the board's ids
  int border_bits = 1;                        ///< width of the black border, in bits
};

/// The smallest dictionary that holds a board's markers: with fewer codes, more faulty bits can be mended.
/// Throws std::invalid_argument for a chessboard, which has none.
MarkerDictionary markerDictionary(const BoardSpec& board);

}  // namespace cartvo
