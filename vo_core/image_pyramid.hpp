#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// One image of a pyramid with a mirrored border around it, so that a patch whose centre lies inside the
/// image can be read without asking at each pixel. Level l holds pixel (x, y) of the image at (x, y) / 2^l.
class PyramidLevel {
 public:
  static constexpr int kBorder = 24;  ///< px

  PyramidLevel() = default;
  /// The image is to be written, then the border.
  explicit PyramidLevel(const cv::Size& size);

  cv::Mat image() const { return padded_({kBorder, kBorder, width(), height()}); }
  void writeBorder();
  /// Whether another copy of this level has the same pixels.
  bool shared() const { return padded_.u != nullptr && padded_.u->refcount > 1; }

  int width() const { return padded_.cols - 2 * kBorder; }
  int height() const { return padded_.rows - 2 * kBorder; }
  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= width() - 1 && pixel.y() <= height() - 1;
  }

  /// The pixel (x, y), which may lie up to kBorder outside the image; the row goes on to its right.
  const std::uint8_t* at(int x, int y) const { return padded_.ptr(y + kBorder) + x + kBorder; }
  /// From one row to the next, in pixels.
  std::ptrdiff_t stride() const { return static_cast<std::ptrdiff_t>(padded_.step); }

 private:
  cv::Mat padded_;
};

/// What one image of a pair is turned into, once, for all stages.
struct ImagePyramid {
  std::vector<PyramidLevel> grey;  ///< Gaussian pyramid, for the KLT and the NCC
  /// Difference of Gaussians around 128 for the SAD, of the levels from kFinestDog on, kDogLevels of them.
  std::vector<PyramidLevel> dog;
};

constexpr int kFinestDog = 1;
constexpr int kDogLevels = 3;

/// `image`: CV_8UC1. `grey_levels` >= 1 levels of grey (fewer if the image is too small to be halved
/// further).
ImagePyramid buildPyramid(const cv::Mat& image, int grey_levels);

/// Builds pyramids of images of one size in memory that it keeps: what is built is valid for as long as
/// somebody has a copy, and then overwritten.
class PyramidPool {
 public:
  explicit PyramidPool(int grey_levels) : grey_levels_(grey_levels) {}
  ImagePyramid build(const cv::Mat& image);

 private:
  int grey_levels_;
  std::vector<ImagePyramid> pyramids_;
  cv::Mat scratch_;
};

}  // namespace cartvo
