#pragma once

#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board_spec.hpp"
#include "calib/board_view.hpp"
#include "calib/stereo_calibration.hpp"
#include "calib/view_quality.hpp"
#include "tools/calibrate/image_pairs.hpp"

namespace cartvo {

/// The views that images give, and those that they do not.
struct BoardViews {
  cv::Size image_size;
  std::vector<BoardView> views;
  std::vector<RejectedView> rejected;
};

/// One view's corners in both images, with what tells whether they are good enough.
struct DetectedView {
  BoardView view;
  ViewQuality left, right;          ///< as far as corners were found
  std::string other_board;          ///< what else the left image shows, if there is no board in it
  cv::Mat left_image, right_image;  ///< of a view from streams, which is on no file
};

DetectedView detectView(const std::string& name, const cv::Mat& left, const cv::Mat& right,
                        const BoardSpec& board);

/// A board's pose has six unknowns; with fewer corners than this nothing is left to tell of the cameras.
inline constexpr std::size_t kFewestCorners = 8;

/// Parts the views that show the board, sharp and well lit, to both cameras, from those that do not.
BoardViews partViews(const std::vector<DetectedView>& detected, cv::Size image_size);

/// As partViews. Throws std::runtime_error if there is none, and names the board that is seen instead if
/// there is one.
BoardViews selectViews(const std::vector<DetectedView>& detected, const BoardSpec& board,
                       cv::Size image_size);

/// Called after each pair with how many are done. May come from another thread, one at a time.
using DetectionProgress = std::function<void(std::size_t done)>;

/// Detects the board in all pairs, on all cores. Throws std::runtime_error naming a file that is unreadable
/// or of another size than the first.
BoardViews findViews(const ImagePairs& pairs, const BoardSpec& board, const DetectionProgress& progress);

}  // namespace cartvo
