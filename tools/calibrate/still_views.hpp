#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board_spec.hpp"
#include "calib/board_view.hpp"
#include "capture/camera_side.hpp"
#include "tools/calibrate/board_views.hpp"

namespace cartvo {

/// Watches two streams that are not synchronised for a board that is held still: then both cameras see the
/// same, whenever they look. A view is taken when in both images no corner's place, on the mean, has moved by
/// 0.3 px for a second; the next one only after the board has moved on.
class StillViews {
 public:
  explicit StillViews(const BoardSpec& board);

  struct Looked {
    bool has_looked = false;
    std::optional<DetectedView> view;
  };

  /// Looks at a camera's next image (CV_8UC1), if the last one looked at is a fifth of a second old:
  /// `time_ns` is when it came. Both cameras' times must be of one clock, to half a second. A view is
  /// returned once it is taken; its corners are means over the second.
  Looked look(CameraSide side, const cv::Mat& grey, std::int64_t time_ns);

  /// What the newest look at a camera found, and where; both empty before the first.
  const std::vector<SeenCorner>& corners(CameraSide side) const;
  cv::Mat image(CameraSide side) const;

  /// What the person who holds the board should do at this moment, as a clause such as "hold it still: 0.4 of
  /// 1 s".
  std::string advice() const;

 private:
  struct Look {
    std::int64_t time_ns = 0;
    std::vector<SeenCorner> corners;
    cv::Mat image;
  };

  static std::int64_t stillNs(const std::deque<Look>& looks);

  const std::deque<Look>& looks(CameraSide side) const { return side == CameraSide::left ? left_ : right_; }
  bool isStill() const;
  DetectedView take();

  BoardSpec board_;
  std::deque<Look> left_, right_;
  std::vector<SeenCorner> last_taken_;  ///< left corners of the last view, until the board has moved on
  std::size_t taken_ = 0;
  std::int64_t first_ns_ = 0;
};

}  // namespace cartvo
