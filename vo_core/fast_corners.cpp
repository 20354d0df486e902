// Features from accelerated segment test, scored by the sum of absolute differences.
#include "vo_core/fast_corners.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include <opencv2/features2d.hpp>

namespace cartvo {
namespace {

/// Offsets of the circle of radius 3, clockwise from the top, in an image of a given row length.
std::array<std::ptrdiff_t, 16> circle(std::ptrdiff_t step) {
  return {-3 * step, -3 * step + 1, -2 * step + 2, -step + 3, 3,  step + 3,  2 * step + 2,  3 * step + 1,
          3 * step,  3 * step - 1,  2 * step - 2,  step - 3,  -3, -step - 3, -2 * step - 2, -3 * step - 1};
}

/// Whether nine neighbours of the ring of sixteen bits are set.
bool hasArc(std::uint32_t bits) {
  const std::uint32_t ring = bits | bits << 16;
  std::uint32_t run = ring & ring >> 1;  // runs of 2, 4, 8
  run &= run >> 2;
  run &= run >> 4;
  return (run & ring >> 8) != 0;
}

std::uint16_t scoreAt(const unsigned char* centre, const std::array<std::ptrdiff_t, 16>& offsets,
                      int threshold) {
  const int grey = *centre;
  // An arc of nine covers one of the top and bottom, and one of the left and right pixel.
  const int top = centre[offsets[0]] - grey;
  const int bottom = centre[offsets[8]] - grey;
  const int right = centre[offsets[4]] - grey;
  const int left = centre[offsets[12]] - grey;
  const bool bright = std::max(top, bottom) > threshold && std::max(right, left) > threshold;
  const bool dark = std::min(top, bottom) < -threshold && std::min(right, left) < -threshold;
  if (!bright && !dark) return 0;

  std::uint32_t bright_bits = 0;
  std::uint32_t dark_bits = 0;
  int bright_sum = 0;
  int dark_sum = 0;
  for (int i = 0; i < 16; ++i) {
    const int difference = centre[offsets[i]] - grey;
    if (difference > threshold) {
      bright_bits |= 1u << i;
      bright_sum += difference;
    } else if (difference < -threshold) {
      dark_bits |= 1u << i;
      dark_sum -= difference;
    }
  }
  if (hasArc(bright_bits)) return static_cast<std::uint16_t>(bright_sum);
  if (hasArc(dark_bits)) return static_cast<std::uint16_t>(dark_sum);
  return 0;
}

}  // namespace

std::uint16_t fastScore(const cv::Mat& image, int x, int y, int threshold) {
  return scoreAt(image.ptr(y) + x, circle(static_cast<std::ptrdiff_t>(image.step)), threshold);
}

std::vector<Corner> findCorners(const cv::Mat& image, const cv::Rect& window, int threshold,
                                cv::Mat& scores) {
  // What OpenCV is given, it searches but for a margin of the circle's radius.
  const cv::Rect searched = cv::Rect(window.x - kFastRadius, window.y - kFastRadius,
                                     window.width + 2 * kFastRadius, window.height + 2 * kFastRadius) &
                            cv::Rect(cv::Point(), image.size());
  std::vector<cv::KeyPoint> found;
  cv::FAST(image(searched), found, threshold, false, cv::FastFeatureDetector::TYPE_9_16);
  const auto offsets = circle(static_cast<std::ptrdiff_t>(image.step));
  std::vector<Corner> corners;
  corners.reserve(found.size());
  for (const cv::KeyPoint& point : found) {
    const int x = searched.x + static_cast<int>(point.pt.x);
    const int y = searched.y + static_cast<int>(point.pt.y);
    const std::uint16_t score = scoreAt(image.ptr(y) + x, offsets, threshold);
    scores.at<std::uint16_t>(y, x) = score;
    corners.push_back({x, y, score});
  }
  return corners;
}

std::vector<Corner> localMaxima(const cv::Mat& scores, const std::vector<Corner>& corners) {
  std::vector<Corner> maxima;
  for (const Corner& corner : corners) {
    const auto* above = scores.ptr<std::uint16_t>(corner.y - 1) + corner.x;
    const auto* row = scores.ptr<std::uint16_t>(corner.y) + corner.x;
    const auto* below = scores.ptr<std::uint16_t>(corner.y + 1) + corner.x;
    const int before = std::max({above[-1], above[0], above[1], row[-1]});
    const int after = std::max({row[1], below[-1], below[0], below[1]});
    if (corner.score > before && corner.score >= after) maxima.push_back(corner);
  }
  return maxima;
}

}  // namespace cartvo
