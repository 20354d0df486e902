#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "vo_core/image/image_pyramid.hpp"

// Search for patches of one image in another one, over both signs of the displacement. It uses neither a
// calibration nor a motion.

namespace cartvo::vo {

/// Least texture of a patch that is searched for, and least correlation of one that is found.
struct PatchDemands {
  double texture = 4.0;       ///< grey values^2, of the weaker direction's mean squared gradient
  double correlation = 0.85;  ///< at the finest level, as that of the stereo search (StereoSettings)
};

/// Finds patches by normalised cross-correlation at a coarse pyramid level, within a share of the image's
/// width to both sides and a 24th of it up and down, and refines them to some tenths of a pixel. Integer
/// arithmetic up to the sums, so that the result is the same on all processors.
class PatchSearch {
 public:
  /// Width over the largest disparity of either sign that is searched for.
  static constexpr int kDisparityShare = 4;

  /// `width`: of the full images, px. `most_levels`: grey levels of the pyramids, if they are limited.
  explicit PatchSearch(int width, const PatchDemands& demands = {},
                       int most_levels = std::numeric_limits<int>::max());

  /// Grey levels that the pyramids must have.
  int levels() const { return coarse_level_ + 1; }

  /// Chooses the patch with the most texture in each cell of a grid; cells without texture give none. Returns
  /// the centres in px of the coarse level, in an order that does not depend on the image.
  const std::vector<Eigen::Vector2i>& choosePatches(const ImagePyramid& image);

  /// Prepares the search in this image, which must outlive it, over the width divided by `column_share` to
  /// both sides.
  void setSearched(const ImagePyramid& image, int column_share);

  /// Searches the image of setSearched() for the patch of `image` at `centre` (choosePatches()). Returns its
  /// displacement, px of the full image; nothing if it is not found or not unique.
  std::optional<Eigen::Vector2d> find(const ImagePyramid& image, const Eigen::Vector2i& centre);

  /// Centre of a patch in px of the full image.
  Eigen::Vector2d fullPixel(const Eigen::Vector2i& centre) const {
    return levelScale(coarse_level_) * centre.cast<double>();
  }

 private:
  std::optional<Eigen::Vector2i> findCoarse(const PyramidLevel& from, const Eigen::Vector2i& centre);
  float loadPatch(const PyramidLevel& from, const Eigen::Vector2i& centre);
  void multiplyFour(const std::int16_t* pairs, std::size_t stride, std::int32_t* products) const;
  void correlateRow(const Eigen::Vector2i& first, int count, float* scores);
  std::optional<Eigen::Vector2i> uniquePeak(int columns, int rows, float norm) const;

  PatchDemands demands_;
  int coarse_level_ = 0;
  const ImagePyramid* searched_ = nullptr;
  int column_share_ = 1;
  std::vector<Eigen::Vector2i> centres_;
  // Sums of the searched coarse image and of its squares over rectangles from the origin, modulo 2^32.
  std::vector<std::uint32_t> sums_, squares_;
  std::vector<std::int16_t> pairs_;    ///< each pixel of the searched coarse image and the one to its right
  std::vector<std::int32_t> weights_;  ///< pixels of the patch, two in a number
  std::int32_t patch_sum_ = 0;         ///< of the pixels of the patch
  std::vector<std::int32_t> products_;
  std::vector<float> scores_;  ///< squared covariances over variances, row by row
};

}  // namespace cartvo::vo
