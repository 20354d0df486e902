#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace cartvo::capture {

/// Part of a picture: all, or one of the two cameras' whose pictures lie side by side or one above the other.
enum class PicturePart : std::uint8_t { whole, left_half, right_half, upper_half, lower_half };

/// That part of a picture, which shares its memory. Of an odd number of columns or rows the last is left out.
inline cv::Mat partOf(const cv::Mat& picture, PicturePart part) {
  const int width = picture.cols / 2, height = picture.rows / 2;
  switch (part) {
    case PicturePart::left_half:
      return picture.colRange(0, width);
    case PicturePart::right_half:
      return picture.colRange(width, 2 * width);
    case PicturePart::upper_half:
      return picture.rowRange(0, height);
    case PicturePart::lower_half:
      return picture.rowRange(height, 2 * height);
    default:
      return picture;
  }
}

}  // namespace cartvo::capture
