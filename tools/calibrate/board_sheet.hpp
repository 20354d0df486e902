#pragma once

#include <string>

#include <opencv2/core/types.hpp>

#include "calib/board_spec.hpp"

namespace cartvo::calibrate {

/// A sheet of paper.
struct Page {
  std::string name;  ///< "A3", or "300x200 mm"
  cv::Size2d size;   ///< as it lies, mm
};

/// Where on its page a board is printed, and what stands beside it. Lengths in mm from the page's top left.
struct BoardSheet {
  BoardSpec board;
  Page page;
  cv::Rect2d pattern;           ///< the board's extent
  cv::Rect2d horizontal_ruler;  ///< its zero at the left, its scale along the top
  cv::Rect2d vertical_ruler;    ///< its zero at the bottom, its scale along the right side
  cv::Point2d text;             ///< left end of the first line of text
};

/// Lays a board out. `page`: A4 to A0 (turned as the board needs it), WIDTHxHEIGHT in mm (taken as it is), or
/// "auto" for the smallest of A4 to A0 that it fits on. Throws std::invalid_argument if there is no such page
/// or the board does not fit, saying how much room there is.
BoardSheet layOutBoard(const BoardSpec& board, const std::string& page);

}  // namespace cartvo::calibrate
