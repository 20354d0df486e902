#pragma once

#include <string>

#include <opencv2/core/types.hpp>

#include "calib/board/board_spec.hpp"

namespace cartvo::calibrate {

/// A sheet of paper.
struct Page {
  std::string name;  ///< "A3", or "300x200 mm"
  cv::Size2d size;   ///< in the orientation used, mm
};

/// Layout of a board, its rulers and its text on a page. Lengths in mm from the top left of the page.
struct BoardSheet {
  calib::BoardSpec board;
  Page page;
  cv::Rect2d pattern;           ///< the printed pattern
  cv::Rect2d horizontal_ruler;  ///< zero at the left, scale along the top
  cv::Rect2d vertical_ruler;    ///< zero at the bottom, scale along the right side
  cv::Point2d text;             ///< left end of the first line of text
};

/// Lays out a board. `page`: A4 to A0 (turned to fit the board), WIDTHxHEIGHT in mm (not turned), or "auto"
/// for the smallest of A4 to A0 that the board fits on. Throws std::invalid_argument if there is no such page
/// or the board does not fit, with the available size.
BoardSheet layOutBoard(const calib::BoardSpec& board, const std::string& page);

}  // namespace cartvo::calibrate
