// Detection of repeated pictures by a hash of their pixels.

#include "capture/frozen_picture_detector.hpp"

#include <cstring>

namespace cartvo::capture {
namespace {

constexpr int kRowStep = 8;

/// Hash of every eighth row (Fowler, Noll, Vo: FNV-1a, eight bytes at a time).
std::uint64_t hashOf(const cv::Mat& image) {
  std::uint64_t value = 14695981039346656037U;
  for (int row = 0; row < image.rows; row += kRowStep) {
    const std::uint8_t* pixels = image.ptr(row);
    for (int column = 0; column + 8 <= image.cols; column += 8) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, pixels + column, sizeof(eight));
      value = (value ^ eight) * 1099511628211U;
    }
  }
  return value;
}

}  // namespace

FrozenPictureDetector::Clock::duration FrozenPictureDetector::update(const cv::Mat& image,
                                                                     Clock::time_point now) {
  const std::uint64_t current = hashOf(image);
  if (hash_ != current) {
    hash_ = current;
    since_ = now;
  }
  return now - since_;
}

}  // namespace cartvo::capture
