#pragma once

// Gaussian and difference-of-Gaussian pyramids of one image, and a pool that reuses their memory.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "vo_core/image/image_mask.hpp"

namespace cartvo::vo {

/// Size of a pixel of this level in px of the full image.
constexpr double levelScale(int level) {
  return 1 << level;
}

/// Size of a level for an image of this size: each level has every other row and column of the one before.
inline cv::Size levelSize(const cv::Size& image, int level) {
  const int more = (1 << level) - 1;
  return {(image.width + more) >> level, (image.height + more) >> level};
}

/// One image of a pyramid with a mirrored border, so that a patch whose centre is inside the image can be
/// read without bounds checks. Pixel (x, y) of the full image is at (x, y) / 2^l in level l. Copies share the
/// pixels.
class PyramidLevel {
 public:
  static constexpr int kBorder = 24;  ///< px

  PyramidLevel() = default;
  /// Allocates memory; the caller writes the image, then calls writeBorder().
  explicit PyramidLevel(const cv::Size& size);

  /// Writable pixels of a row; up to kBlock pixels beyond the width are scratch space.
  std::uint8_t* row(int y) { return origin_ + y * stride_; }
  static constexpr int kBlock =
      64;  ///< px, maximum of a SIMD block: overrun of reads and writes at the end of a row
  void writeBorder();

  int width() const { return width_; }
  int height() const { return height_; }
  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= width_ - 1 && pixel.y() <= height_ - 1;
  }

  /// Pointer to pixel (x, y), up to kBorder outside the image; the row continues to the right.
  const std::uint8_t* at(int x, int y) const { return origin_ + y * stride_ + x; }
  /// Distance of rows in pixels.
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

/// Pyramids of one image, built once for all stages.
struct ImagePyramid {
  std::vector<PyramidLevel> grey;  ///< Gaussian pyramid, for KLT and NCC
  /// Differences of Gaussians, offset by 128, for SAD: kDogLevels levels from kFinestDog on.
  std::vector<PyramidLevel> dog;
  ImageMask mask;  ///< where patches may be taken from the image
};

/// Whether both have this grey level; small images have fewer levels.
inline bool bothHave(const ImagePyramid& a, const ImagePyramid& b, int level) {
  return static_cast<std::size_t>(level) < std::min(a.grey.size(), b.grey.size());
}

constexpr int kFinestDog = 1;
constexpr int kDogLevels = 3;

/// Builds the pyramids of `image` (CV_8UC1) with `grey_levels` >= 1 grey levels, or fewer if the image is too
/// small. Each level is the one before after a 5x5 binomial filter, every other row and column.
ImagePyramid buildPyramid(const cv::Mat& image, int grey_levels);

/// Shared ownership of a pyramid: copies neither pixels nor lists of levels.
using SharedPyramid = std::shared_ptr<const ImagePyramid>;

/// Exclusive use of a pyramid's memory, to write the image into it before PyramidPool::build(). Empty by
/// default; returns the memory to the pool when it is destroyed.
class PyramidLease {
 public:
  PyramidLease() = default;

  /// The memory for the image (CV_8UC1), an empty matrix of an empty lease.
  cv::Mat image() const;
  /// True if `image` lies in this memory.
  bool holds(const cv::Mat& image) const;

 private:
  friend class PyramidPool;
  explicit PyramidLease(std::shared_ptr<ImagePyramid> pyramid) : pyramid_(std::move(pyramid)) {}

  std::shared_ptr<ImagePyramid> pyramid_;
};

/// Builds pyramids of images of one size in memory that it reuses: a pyramid is overwritten once its last
/// owner has released it. Not thread-safe.
class PyramidPool {
 public:
  explicit PyramidPool(int grey_levels) : PyramidPool(grey_levels, ImageMask()) {}
  /// `mask`: that of each pyramid.
  PyramidPool(int grey_levels, ImageMask mask) : grey_levels_(grey_levels), mask_(std::move(mask)) {}

  /// Leases memory for an image of `size`.
  PyramidLease lease(const cv::Size& size);
  /// Builds the pyramid of the image that was written into the lease, which must not be empty; copies
  /// nothing.
  SharedPyramid build(PyramidLease lease);
  /// Builds the pyramid of a copy of `image` (CV_8UC1).
  SharedPyramid build(const cv::Mat& image);

 private:
  std::shared_ptr<ImagePyramid> findFree(const cv::Size& size);
  void fill(ImagePyramid& pyramid);

  int grey_levels_;
  ImageMask mask_;
  std::vector<std::shared_ptr<ImagePyramid>> pyramids_;
  std::vector<PyramidLevel> halves_;     ///< grey levels that only the differences of Gaussians need
  std::vector<std::uint16_t> row_sums_;  ///< five rows after the horizontal filter
};

}  // namespace cartvo::vo
