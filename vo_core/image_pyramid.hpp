#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// px of the image for each of a level.
constexpr double levelScale(int level) {
  return 1 << level;
}

/// The size of a level, from the image's own: each has every other row and column of the one before.
inline cv::Size levelSize(const cv::Size& image, int level) {
  const int more = (1 << level) - 1;
  return {(image.width + more) >> level, (image.height + more) >> level};
}

/// One image of a pyramid with a mirrored border around it, so that a patch whose centre lies inside the
/// image can be read without asking at each pixel. Level l holds pixel (x, y) of the image at (x, y) / 2^l.
/// Copies have the same pixels.
class PyramidLevel {
 public:
  static constexpr int kBorder = 24;  ///< px

  PyramidLevel() = default;
  /// The image is to be written, then the border.
  explicit PyramidLevel(const cv::Size& size);

  /// The pixels of a row, to be written; up to kBlock more than the width, which mean nothing.
  std::uint8_t* row(int y) { return origin_ + y * stride_; }
  static constexpr int kBlock = 64;  ///< px, worked on at once at most: what is read and written past an end
  void writeBorder();

  int width() const { return width_; }
  int height() const { return height_; }
  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= width_ - 1 && pixel.y() <= height_ - 1;
  }

  /// The pixel (x, y), which may lie up to kBorder outside the image; the row goes on to its right.
  const std::uint8_t* at(int x, int y) const { return origin_ + y * stride_ + x; }
  /// From one row to the next, in pixels.
  std::ptrdiff_t stride() const { return stride_; }

 private:
  struct alignas(kBlock) Block {
    std::array<std::uint8_t, kBlock> pixels;
  };

  std::shared_ptr<Block[]> memory_;
  std::uint8_t* origin_ = nullptr;  ///< pixel (0, 0)
  std::ptrdiff_t stride_ = 0;
  int width_ = 0, height_ = 0;
};

/// What one image of a pair is turned into, once, for all stages.
struct ImagePyramid {
  std::vector<PyramidLevel> grey;  ///< Gaussian pyramid, for the KLT and the NCC
  /// Difference of Gaussians around 128 for the SAD, of the levels from kFinestDog on, kDogLevels of them.
  std::vector<PyramidLevel> dog;
};

/// Whether both have that level of grey: small images cannot be halved as often.
inline bool bothHave(const ImagePyramid& a, const ImagePyramid& b, int level) {
  return static_cast<std::size_t>(level) < std::min(a.grey.size(), b.grey.size());
}

constexpr int kFinestDog = 1;
constexpr int kDogLevels = 3;

/// `image`: CV_8UC1. `grey_levels` >= 1 levels of grey (fewer if the image is too small to be halved
/// further): each is the one before blurred by a binomial filter of 5x5, every other row and column.
ImagePyramid buildPyramid(const cv::Mat& image, int grey_levels);

/// A pyramid that several hold: handing it on copies neither pixels nor lists of levels.
using SharedPyramid = std::shared_ptr<const ImagePyramid>;

/// Builds pyramids of images of one size in memory that it keeps: what is built is valid for as long as
/// somebody holds it, and then overwritten.
class PyramidPool {
 public:
  explicit PyramidPool(int grey_levels) : grey_levels_(grey_levels) {}

  /// Where the next image may be written (CV_8UC1): build() of it copies nothing. Valid until that.
  cv::Mat place(const cv::Size& size);
  SharedPyramid build(const cv::Mat& image);

 private:
  std::shared_ptr<ImagePyramid>& findFree(const cv::Size& size);
  void fill(ImagePyramid& pyramid);

  int grey_levels_;
  std::vector<std::shared_ptr<ImagePyramid>> pyramids_;
  std::vector<PyramidLevel> halves_;     ///< levels that are wanted for their difference of Gaussians only
  std::vector<std::uint16_t> row_sums_;  ///< five rows, filtered along them
};

}  // namespace cartvo
