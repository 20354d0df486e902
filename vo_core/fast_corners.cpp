// Features from accelerated segment test, scored by the sum of absolute differences.
#include "vo_core/fast_corners.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

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

cv::Rect awayFromEdge(const cv::Rect& window, const cv::Size& size) {
  return window &
         cv::Rect(kFastRadius, kFastRadius, size.width - 2 * kFastRadius, size.height - 2 * kFastRadius);
}

}  // namespace

std::uint16_t fastScore(const cv::Mat& image, int x, int y, int threshold) {
  return scoreAt(image.ptr(y) + x, circle(static_cast<std::ptrdiff_t>(image.step)), threshold);
}

void scoreWindow(const cv::Mat& image, const cv::Rect& window, int threshold, cv::Mat& scores) {
  scores(window).setTo(0);
  const auto offsets = circle(static_cast<std::ptrdiff_t>(image.step));
  const cv::Rect inner = awayFromEdge(window, image.size());
  for (int y = inner.y; y < inner.y + inner.height; ++y) {
    const unsigned char* row = image.ptr(y);
    auto* out = scores.ptr<std::uint16_t>(y);
    for (int x = inner.x; x < inner.x + inner.width; ++x)
      out[x] = scoreAt(row + x, offsets, threshold);
  }
}

std::vector<Corner> localMaxima(const cv::Mat& scores, const cv::Rect& window) {
  std::vector<Corner> maxima;
  const cv::Rect inner = awayFromEdge(window, scores.size());
  for (int y = inner.y; y < inner.y + inner.height; ++y) {
    const auto* above = scores.ptr<std::uint16_t>(y - 1);
    const auto* row = scores.ptr<std::uint16_t>(y);
    const auto* below = scores.ptr<std::uint16_t>(y + 1);
    for (int x = inner.x; x < inner.x + inner.width; ++x) {
      const std::uint16_t score = row[x];
      if (score == 0) continue;
      const int before = std::max({above[x - 1], above[x], above[x + 1], row[x - 1]});
      const int after = std::max({row[x + 1], below[x - 1], below[x], below[x + 1]});
      if (score > before && score >= after) maxima.push_back({x, y, score});
    }
  }
  return maxima;
}

}  // namespace cartvo
