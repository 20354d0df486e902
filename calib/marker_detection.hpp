#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board_spec.hpp"
#include "calib/board_view.hpp"

namespace cartvo {

/// The inner corners that lie beside a marker which is read. Empty below two markers.
std::vector<SeenCorner> detectCharuco(const cv::Mat& grey, const Charuco& board);

/// The corners of the tags that are read. Empty below two tags.
std::vector<SeenCorner> detectAprilGrid(const cv::Mat& grey, const AprilGrid& board);

/// A marker of the board's dictionary that the board does not have: "a tag with the number 40"; empty if
/// none.
std::string markerBeyondSeen(const cv::Mat& grey, const BoardSpec& board);

}  // namespace cartvo
