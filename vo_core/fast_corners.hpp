#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace cartvo {

struct Corner {
  int x = 0, y = 0;  ///< px
  std::uint16_t score = 0;
};

constexpr int kFastRadius = 3;  ///< px; pixels closer than this to the edge are no corners

/// FAST-9 (E. Rosten, T. Drummond, "Machine learning for high-speed corner detection", 2006): at least nine
/// contiguous pixels of the circle of sixteen are all brighter, or all darker, than the centre by more than
/// `threshold`. The score is the sum of absolute differences between the centre and those pixels of the
/// circle that differ so (thesis 4.9); 0: no corner. (x, y) must lie kFastRadius inside the CV_8UC1 image.
std::uint16_t fastScore(const cv::Mat& image, int x, int y, int threshold);

/// The corners of `window`, in reading order, their scores also written into `scores` (CV_16UC1, the image's
/// size, else zero). Pixels too close to the edge of the image are none.
std::vector<Corner> findCorners(const cv::Mat& image, const cv::Rect& window, int threshold, cv::Mat& scores);

/// Those corners whose score is the greatest of their 3x3 neighbours' (non-maximum suppression; of equal ones
/// the first in reading order stays).
std::vector<Corner> localMaxima(const cv::Mat& scores, const std::vector<Corner>& corners);

}  // namespace cartvo
