// Digest of an image, to recognise the same picture.

#include "common/picture_digest.hpp"

#include <algorithm>
#include <cstring>

namespace cartvo {
namespace {

constexpr int kRowStep = 8;
// Least share of pixels that differ from their left neighbour, as one in so many. A picture of texture and
// noise has more than half, a black one with a line of text less than a 20th.
constexpr int kVariedShare = 8;

}  // namespace

/// Fowler, Noll, Vo: FNV-1a, eight bytes at a time, with the upper half of each product mixed into the lower
/// one, because a product carries upwards only.
std::uint64_t pictureDigest(const cv::Mat& image) {
  std::uint64_t digest = 14695981039346656037U;
  for (int row = 0; row < image.rows; row += kRowStep) {
    const std::uint8_t* const pixels = image.ptr(row);
    for (int column = 0; column < image.cols; column += static_cast<int>(sizeof digest)) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, pixels + column, std::min<std::size_t>(sizeof eight, image.cols - column));
      digest = (digest ^ eight) * 1099511628211U;
      digest ^= digest >> 32;
    }
  }
  return digest;
}

bool isUniform(const cv::Mat& image) {
  std::int64_t varied = 0;
  std::int64_t pixels = 0;
  for (int row = 0; row < image.rows; row += kRowStep) {
    const std::uint8_t* const values = image.ptr(row);
    for (int column = 1; column < image.cols; ++column)
      varied += values[column] != values[column - 1] ? 1 : 0;
    pixels += image.cols;
  }
  return varied * kVariedShare < pixels;
}

}  // namespace cartvo
