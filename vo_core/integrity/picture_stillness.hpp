#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "vo_core/odometry_estimate.hpp"
#include "vo_core/stereo_masks.hpp"

namespace cartvo::vo {

/// Patches of an image, by which a later one shows whether it is the same picture, whatever noise a sensor or
/// an encoder has added.
class PicturePatches {
 public:
  /// Takes the patches with the most texture, one in each cell of the image.
  void take(const cv::Mat& image, const cv::Mat& mask);
  /// Share of the patches that have kept their place, of those that show it; nothing if few do.
  std::optional<double> stillShare(const cv::Mat& image) const;

 private:
  static constexpr int kSize = 9;  // px
  struct Patch {
    cv::Point corner;
    std::array<std::uint8_t, kSize * kSize> pixels;
  };

  static int difference(const Patch& patch, const cv::Mat& image, cv::Point shift);
  static int differenceAround(const Patch& patch, const cv::Mat& image);
  std::vector<Patch> patches_;
};

/// Finds a camera that shows the same picture while the other one moves: both see the same world, so that
/// about as many patches move in both.
class PictureStillness {
 public:
  /// Compares the next pair with an earlier one: the last at which a picture had moved, or up to ten pairs
  /// ago. What two comparisons in a row show counts.
  void update(const StereoImages& images, const StereoMasks& masks);
  bool leftAlone() const { return alone_ == Alone::left; }    ///< only the left picture is still
  bool rightAlone() const { return alone_ == Alone::right; }  ///< only the right one is

 private:
  enum class Alone : std::uint8_t { none, left, right };
  PicturePatches left_, right_;
  int pairs_ = 0;             ///< since the patches were taken
  Alone seen_ = Alone::none;  ///< by the last patches
  Alone alone_ = Alone::none;
};

}  // namespace cartvo::vo
