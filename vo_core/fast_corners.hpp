#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace cartvo {

struct Corner {
  int x = 0, y = 0;  ///< px
  std::uint16_t score = 0;
};

constexpr int kFastRadius = 3;            ///< px; pixels closer than this to the edge are no corners
constexpr std::uint8_t kNoCorners = 255;  ///< a threshold that nothing passes

/// How many of an area's corners non-maximum suppression can leave: one of each four pixels.
constexpr std::size_t mostCorners(int width, int height) {
  return static_cast<std::size_t>((width + 1) / 2) * ((height + 1) / 2);
}

/// FAST-9 (E. Rosten, T. Drummond, "Machine learning for high-speed corner detection", 2006): at least nine
/// contiguous pixels of the circle of sixteen are all brighter, or all darker, than the centre by more than
/// `threshold`. The score is the sum of absolute differences between the centre and those pixels of the
/// circle that differ so (thesis 4.9); 0: no corner. (x, y) must lie kFastRadius inside the CV_8UC1 image.
std::uint16_t fastScore(const cv::Mat& image, int x, int y, int threshold);

/// The thresholds of an image's pixels: windows side by side have their own, and all rows of a row of windows
/// the same.
class WindowThresholds {
 public:
  /// No corners anywhere. Window row r of n holds the image's rows [r height / n, (r + 1) height / n).
  WindowThresholds(const cv::Size& image_size, int window_rows);

  void set(const cv::Rect& window, std::uint8_t threshold);
  /// Of the pixels of one row of the image.
  const std::uint8_t* row(int y) const { return &thresholds_[static_cast<std::size_t>(begin_[y])]; }

 private:
  std::vector<std::uint8_t> thresholds_;  ///< of each row of windows, an image's width of them
  std::vector<int> begin_;                ///< in thresholds_, of each row of the image
};

/// Finds corners in memory that it keeps from one image to the next.
class CornerFinder {
 public:
  /// Memory for so many rows of images so wide, so that none is asked for later.
  void reserve(int columns, int rows);

  /// The corners of those rows of `image` (CV_8UC1, of the thresholds' size) whose score is the greatest of
  /// their 3x3 neighbours' (non-maximum suppression; of equal ones the first in reading order stays), in
  /// reading order. Pixels too close to the edge of the image are none. Valid until the next call.
  const std::vector<Corner>& find(const cv::Mat& image, const cv::Range& rows,
                                  const WindowThresholds& thresholds);

 private:
  /// One row before suppression.
  struct ScoredRow {
    std::vector<std::uint16_t> scores;  ///< of all columns; 0 where there is no corner
    std::vector<int> blocks;            ///< of columns with corners: where each begins
    int block_count = 0;
  };

  void score(const cv::Mat& image, int y, const WindowThresholds& thresholds);
  void suppress(int y);
  ScoredRow& at(int y) { return rows_[static_cast<std::size_t>((y + kRows) % kRows)]; }

  static constexpr int kRows = 3;
  std::array<ScoredRow, kRows> rows_;  ///< the last ones of the image
  std::vector<int> columns_;           ///< of one row's maxima
  std::vector<Corner> maxima_;
};

}  // namespace cartvo
