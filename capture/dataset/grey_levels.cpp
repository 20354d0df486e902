// Measurement of the values that images use, and conversion to 8 bits.
#include "capture/dataset/grey_levels.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "capture/dataset/image_files.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

/// The values of a sample of images of one bit depth.
struct Values {
  std::size_t images = 0;
  int low = 0, high = 0;  ///< without a thousandth of the pixels of each image
  double mean = 0.0;      ///< of the images' means

  bool exist() const { return images > 0; }
  void add(const cv::Mat& image);
};

struct CameraValues {
  Values of_8, of_16;
};

/// Smallest value that more than `skipped` pixels do not exceed.
int valueAbove(const std::vector<std::size_t>& counts, std::size_t skipped) {
  std::size_t passed = 0;
  for (std::size_t value = 0; value < counts.size(); ++value) {
    passed += counts[value];
    if (passed > skipped) return static_cast<int>(value);
  }
  return 0;
}

template <typename Value>
std::vector<std::size_t> histogram(const cv::Mat& image) {
  std::vector<std::size_t> counts(std::size_t{1} << (8U * sizeof(Value)));
  for (int row = 0; row < image.rows; ++row) {
    const auto* const values = image.ptr<Value>(row);
    for (int column = 0; column < image.cols; ++column)
      ++counts[values[column]];
  }
  return counts;
}

void Values::add(const cv::Mat& image) {
  constexpr std::size_t kIgnoredFraction = 1000;  // one of so many pixels
  const auto counts =
      image.depth() == CV_16U ? histogram<std::uint16_t>(image) : histogram<std::uint8_t>(image);
  const std::size_t pixels = image.total(), ignored = pixels / kIgnoredFraction;
  const int image_low = valueAbove(counts, ignored), image_high = valueAbove(counts, pixels - ignored - 1);
  low = exist() ? std::min(low, image_low) : image_low;
  high = std::max(high, image_high);
  mean += (cv::mean(image)[0] - mean) / static_cast<double>(++images);
}

CameraValues sampleValues(const std::vector<fs::path>& files) {
  constexpr std::size_t kSample = 20;
  constexpr int kBright = 128;
  const std::size_t stride = std::max<std::size_t>(1, files.size() / kSample);
  CameraValues values;
  for (std::size_t i = 0; i < files.size() && values.of_8.high < kBright; i += stride) {
    try {
      const cv::Mat image = decodeGreyImage(files[i]);
      if (image.depth() == CV_8U) values.of_8.add(image);
      if (image.depth() == CV_16U) values.of_16.add(image);
    } catch (const std::runtime_error&) {
      continue;  // is reported when the image is needed
    }
  }
  return values;
}

/// The range of 16-bit images with these values.
GreyRange rangeOf(const Values& values) {
  constexpr int kMargin = 8;    // the part of low to high that is added at both ends is one of so many
  constexpr int kMinSpan = 16;  // of images that are not uniform
  GreyRange range;
  for (const int bits : {14, 12, 10, 8}) {
    if (values.high > 0 && values.high < 1 << bits) range.used_bits = bits;
  }
  // Thermal cameras: a few hundred values far from 0.
  const int span = values.high - values.low;
  if (range.used_bits == 8 || span < kMinSpan || span >= 1 << (range.used_bits - 2)) return range;
  range.black = static_cast<std::uint16_t>(std::max(0, values.low - span / kMargin));
  const int needed = values.high + span / kMargin - range.black;
  range.used_bits = 8;
  while (range.used_bits < 16 && needed >= 1 << range.used_bits)
    ++range.used_bits;
  return range;
}

Values merged(const Values& a, const Values& b) {
  if (!a.exist() || !b.exist()) return a.exist() ? a : b;
  return {a.images + b.images, std::min(a.low, b.low), std::max(a.high, b.high), (a.mean + b.mean) / 2};
}

/// The 16-bit values of a camera whose images have all 16 bits.
Values sixteenBitValues(const CameraValues& camera) {
  return camera.of_8.exist() ? Values() : camera.of_16;
}

/// Whether the means show that the cameras' values are of different scales: both see the same scene.
bool haveOneScale(const Values& left, const Values& right) {
  constexpr double kMaxRatio = 2.5;
  if (!left.exist() || !right.exist()) return true;
  return std::max(left.mean, right.mean) <= kMaxRatio * std::min(left.mean, right.mean);
}

int largestOf(const CameraValues& camera, const GreyRange& range) {
  if (camera.of_8.exist()) return camera.of_8.high;
  if (!camera.of_16.exist()) return 255;
  const int above_black = std::max(0, camera.of_16.high - range.black);
  return std::min(255, above_black >> (range.used_bits - 8));
}

}  // namespace

GreyLevels measureGreyLevels(const std::vector<fs::path>& left, const std::vector<fs::path>& right) {
  const CameraValues of_left = sampleValues(left), of_right = sampleValues(right);
  const Values left_values = sixteenBitValues(of_left), right_values = sixteenBitValues(of_right);
  GreyLevels levels;
  // One range for both keeps one brightness the same in both.
  const Values both = merged(left_values, right_values);
  const bool is_common = haveOneScale(left_values, right_values);
  if (left_values.exist()) levels.left = rangeOf(is_common ? both : left_values);
  if (right_values.exist()) levels.right = rangeOf(is_common ? both : right_values);
  levels.largest = std::max(largestOf(of_left, levels.left), largestOf(of_right, levels.right));
  return levels;
}

cv::Mat toEightBits(const cv::Mat& image, const GreyRange& range) {
  const int shift = range.used_bits - 8;
  cv::Mat grey(image.size(), CV_8UC1);
  // Truncation instead of rounding: 16 bits become the 8 upper ones.
  for (int row = 0; row < image.rows; ++row) {
    const auto* const values = image.ptr<std::uint16_t>(row);
    std::transform(values, values + image.cols, grey.ptr<std::uint8_t>(row), [&](std::uint16_t value) {
      return static_cast<std::uint8_t>(std::clamp((value - range.black) >> shift, 0, 255));
    });
  }
  return grey;
}

}  // namespace cartvo::capture
