#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <opencv2/core/mat.hpp>

// Values that 16-bit images use, and how these become 8 bits.

namespace cartvo::capture {

/// 16-bit values as 8 bits: (value - black) / 2^(used_bits - 8), limited to 0 to 255.
struct GreyRange {
  int used_bits = 16;       ///< 8 to 16
  std::uint16_t black = 0;  ///< above 0 only for images that use a small part of their values
  bool operator==(const GreyRange&) const = default;
};

/// The values that the images of two cameras use. For 8-bit images the ranges are GreyRange().
struct GreyLevels {
  GreyRange left, right;  ///< equal, unless the cameras' values are of different scales
  int largest = 255;      ///< of 255, after the conversion
};

/// Measures a sample of both cameras' files; of bright images of 8 bits only one. A thousandth of the darkest
/// and of the brightest pixels does not count, nor do files that cannot be decoded.
GreyLevels measureGreyLevels(const std::vector<std::filesystem::path>& left,
                             const std::vector<std::filesystem::path>& right);

/// Converts a CV_16UC1 image to CV_8UC1.
cv::Mat toEightBits(const cv::Mat& image, const GreyRange& range);

}  // namespace cartvo::capture
