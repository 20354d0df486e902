#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/board_view.hpp"

namespace cartvo::calib {

/// Detects the inner corners that are adjacent to a detected marker. Empty with fewer than two markers.
std::vector<SeenCorner> detectCharuco(const cv::Mat& grey, const Charuco& board);

/// Detects the corners of the detected tags. Empty with fewer than two tags.
std::vector<SeenCorner> detectAprilGrid(const cv::Mat& grey, const AprilGrid& board);

/// Describes a marker of the board's dictionary that is not on the board: "a marker with the number 40".
/// Empty if there is none.
std::string describeUnknownMarker(const cv::Mat& grey, const BoardSpec& board);

}  // namespace cartvo::calib
