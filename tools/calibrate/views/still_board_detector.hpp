#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/board_view.hpp"
#include "capture/camera_side.hpp"
#include "tools/calibrate/views/board_views.hpp"

namespace cartvo {

/// Detects boards that are held still in front of two unsynchronised cameras, since the exposure times do not
/// matter then. A view is taken when the mean motion of the corners stays below 0.3 px for a second in both
/// images; the next one only after the board has moved by 8 px.
class StillBoardDetector {
 public:
  explicit StillBoardDetector(const calib::BoardSpec& board);

  struct UpdateResult {
    bool is_processed = false;         ///< whether the board was searched in the image
    std::optional<DetectedView> view;  ///< the view, if one was taken
  };

  /// Processes the next image (CV_8UC1) of a camera, unless the last processed one is less than 0.2 s older.
  /// `time_ns`: arrival time of the image; the cameras' clocks must agree within half a second. The corners
  /// of a view are means over the second.
  UpdateResult update(capture::CameraSide side, const cv::Mat& grey, std::int64_t time_ns);

  /// Corners and image of the newest processed image of a camera. Empty before the first.
  const std::vector<calib::SeenCorner>& corners(capture::CameraSide side) const;
  cv::Mat image(capture::CameraSide side) const;

  /// Instruction for the person who holds the board, such as "hold it still: 0.4 of 1 s".
  std::string advice() const;

 private:
  struct Detection {
    std::int64_t time_ns = 0;
    std::vector<calib::SeenCorner> corners;
    cv::Mat image;
  };

  static std::int64_t stillNs(const std::deque<Detection>& detections);

  const std::deque<Detection>& detections(capture::CameraSide side) const {
    return side == capture::CameraSide::left ? left_ : right_;
  }
  bool isStill() const;
  DetectedView takeView();

  calib::BoardSpec board_;
  std::deque<Detection> left_, right_;
  std::vector<calib::SeenCorner>
      last_taken_;  ///< left corners of the last view, until the board has moved on
  std::size_t taken_ = 0;
  std::int64_t first_ns_ = 0;
};

}  // namespace cartvo
