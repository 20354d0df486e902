#pragma once

#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/board_view.hpp"
#include "calib/board/view_coverage.hpp"
#include "calib/solver/stereo_calibration.hpp"
#include "tools/calibrate/views/image_pairs.hpp"

namespace cartvo {

/// Usable and rejected views.
struct BoardViews {
  cv::Size image_size;
  std::vector<calib::BoardView> views;
  std::vector<calib::RejectedView> rejected;
};

/// The corners of a view in both images, with their image quality.
struct DetectedView {
  calib::BoardView view;
  calib::ViewQuality left, right;   ///< valid only if corners were found
  std::string other_board;          ///< a different board in the left image, see describeOtherBoard
  cv::Mat left_image, right_image;  ///< only of a view from streams, since it is in no file
};

/// Detects the board in a pair of images (CV_8UC1) and measures the image quality.
DetectedView detectView(const std::string& name, const cv::Mat& left, const cv::Mat& right,
                        const calib::BoardSpec& board);

/// Minimum number of corners per image. The board's pose alone has six unknowns; with fewer corners too few
/// equations remain for the cameras.
inline constexpr std::size_t kMinCornersPerImage = 8;

/// Separates the views in which both cameras see the board sharp and well lit from the others.
BoardViews classifyViews(const std::vector<DetectedView>& detected, cv::Size image_size);

/// As classifyViews. Throws std::runtime_error if no view is usable, naming the board that is visible instead
/// if there is one.
BoardViews selectViews(const std::vector<DetectedView>& detected, const calib::BoardSpec& board,
                       cv::Size image_size);

/// A left image in which the board was found.
struct LargerBoardSample {
  std::string name;
  cv::Mat image;
};

/// Number of samples that are enough for refuseLargerBoard.
inline constexpr std::size_t kLargerBoardSamples = 5;

/// Throws std::runtime_error if two samples (the only one) show the same chessboard with more corners than
/// `board`, of which the detected corners are a part.
void refuseLargerBoard(const std::vector<LargerBoardSample>& samples, const calib::BoardSpec& board);

/// Called after each pair with the number of pairs processed. Calls may come from other threads, one at a
/// time.
using DetectionProgress = std::function<void(std::size_t done)>;

/// Detects the board in all pairs, on all cores, and selects the usable views. Throws std::runtime_error
/// naming a file that is unreadable or differs in size from the first, and as selectViews.
BoardViews findViews(const ImagePairs& pairs, const calib::BoardSpec& board,
                     const DetectionProgress& progress);

}  // namespace cartvo
