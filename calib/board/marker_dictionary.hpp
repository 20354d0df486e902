#pragma once

#include <string>

#include <opencv2/aruco.hpp>

#include "calib/board/board_spec.hpp"

namespace cartvo::calib {

/// ArUco dictionary of a board's markers, to draw and to detect them.
struct MarkerDictionary {
  cv::Ptr<cv::aruco::Dictionary> dictionary;  ///< contains at least the board's ids
  int border_bits = 1;                        ///< width of the black border, in bits
};

/// The smallest dictionary that contains a board's markers, since a smaller one corrects more bit errors.
/// Throws std::invalid_argument for a chessboard, which has no markers.
MarkerDictionary markerDictionary(const BoardSpec& board);

/// Name of this dictionary in OpenCV and in other programs that print boards, such as "DICT_4X4_50"; empty
/// for a chessboard.
std::string dictionaryName(const BoardSpec& board);

}  // namespace cartvo::calib
