// Digest of an image, to recognise the same picture.

#include "common/picture_digest.hpp"

#include <algorithm>

#include "common/digest.hpp"

namespace cartvo {
namespace {

constexpr int kRowStep = 8;
// Least share of pixels that differ from their left neighbour, as one in so many. A picture of texture and
// noise has more than half, a black one with a line of text less than a 20th.
constexpr int kVariedShare = 8;

/// 255 for each byte that is not zero.
std::uint64_t nonZeroBytes(std::uint64_t eight) {
  eight |= (eight >> 4) & 0x0f0f0f0f0f0f0f0fU;
  eight |= (eight >> 2) & 0x3333333333333333U;
  eight |= (eight >> 1) & 0x5555555555555555U;
  return 255U * (eight & 0x0101010101010101U);
}

}  // namespace

std::uint64_t pictureDigest(const cv::Mat& image) {
  return pictureDigest(image, {});
}

std::uint64_t pictureDigest(const cv::Mat& image, const cv::Mat& mask) {
  constexpr std::size_t kBytes = sizeof(std::uint64_t);
  Digest digest;
  for (int row = 0; row < image.rows; row += kRowStep) {
    const std::uint8_t* const pixels = image.ptr(row);
    const std::uint8_t* const used = mask.empty() ? nullptr : mask.ptr(row);
    for (int column = 0; column < image.cols; column += static_cast<int>(kBytes)) {
      const std::size_t count = std::min<std::size_t>(kBytes, image.cols - column);
      std::uint64_t eight = eightBytes(pixels + column, count);
      if (used != nullptr) eight &= nonZeroBytes(eightBytes(used + column, count));
      digest.add(eight);
    }
  }
  return digest.value();
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
