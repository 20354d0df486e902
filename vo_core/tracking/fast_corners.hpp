#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

// FAST-9 corner detection with non-maximum suppression.

namespace cartvo::vo {

/// A corner of an image and its FAST score.
struct Corner {
  int x = 0, y = 0;  ///< px
  std::uint16_t score = 0;
};

constexpr int kFastRadius = 3;            ///< px; pixels closer than this to the edge are no corners
constexpr std::uint8_t kNoCorners = 255;  ///< threshold that no pixel passes

/// Maximum number of corners that non-maximum suppression leaves in an area: one of each four pixels.
constexpr std::size_t maximumCorners(int width, int height) {
  return static_cast<std::size_t>((width + 1) / 2) * ((height + 1) / 2);
}

/// FAST-9 (E. Rosten, T. Drummond, "Machine learning for high-speed corner detection", 2006): at least nine
/// contiguous pixels of the circle of sixteen are all brighter, or all darker, than the centre by more than
/// `threshold`. The score is the sum of absolute differences between the centre and those pixels of the
/// circle that differ so (thesis 4.9); 0: no corner. (x, y) must lie kFastRadius inside the CV_8UC1 image.
std::uint16_t fastScore(const cv::Mat& image, int x, int y, int threshold);

/// FAST thresholds of the pixels of an image. Windows side by side have different thresholds; all image rows
/// of one row of windows have the same.
class WindowThresholds {
 public:
  /// Starts without corners anywhere. Window row r of n contains the image rows [r height / n, (r + 1) height
  /// / n).
  WindowThresholds(const cv::Size& image_size, int window_rows);

  void set(const cv::Rect& window, std::uint8_t threshold);
  /// Thresholds of the pixels of image row y.
  const std::uint8_t* row(int y) const { return &thresholds_[static_cast<std::size_t>(begin_[y])]; }

 private:
  std::vector<std::uint8_t> thresholds_;  ///< for each row of windows, one value per image column
  std::vector<int> begin_;                ///< index into thresholds_ of each image row
};

/// Finds corners; reuses its memory from one image to the next.
class CornerFinder {
 public:
  /// Reserves memory for images of this size, so that find() does not allocate.
  void reserve(int columns, int rows);

  /// Corners in the given rows of `image` (CV_8UC1, of the thresholds' size) whose score is the greatest in
  /// its 3x3 neighbourhood (non-maximum suppression; of equal ones the first in reading order stays), in
  /// reading order. Pixels closer than kFastRadius to the edge of the image are no corners. Valid until the
  /// next call.
  const std::vector<Corner>& find(const cv::Mat& image, const cv::Range& rows,
                                  const WindowThresholds& thresholds);

 private:
  /// Scores of one row before suppression.
  struct ScoredRow {
    std::vector<std::uint16_t> scores;  ///< of all columns; 0 where there is no corner
    std::vector<int> blocks;            ///< first columns of the blocks with corners
    int block_count = 0;
  };

  void score(const cv::Mat& image, int y, const WindowThresholds& thresholds);
  void suppress(int y);
  ScoredRow& at(int y) { return rows_[static_cast<std::size_t>((y + kRows) % kRows)]; }

  static constexpr int kRows = 3;
  std::array<ScoredRow, kRows> rows_;  ///< the last rows that were scored
  std::vector<int> columns_;           ///< columns of one row's maxima
  std::vector<Corner> maxima_;
};

}  // namespace cartvo::vo
