#pragma once

#include <Eigen/Core>

#include "vo_core/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

struct KltResult {
  bool found = false;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< px, in the image after
  double correlation = 0.0;                            ///< normalised, of the patch before and after
};

/// Follows the 15x15 patch around `from` in the grey levels of `before` to those of `after`, beginning at
/// `guess` (px): a shift (trackShift), coarse to fine in so many levels, then an affine alignment
/// (alignAffine). Not found: no texture, left the image, or correlates less than
/// settings.minimum_correlation. Pixels are interpolated exactly and equations solved in floating point:
/// OpenCV's fixed-point KLT underestimates flow by 0.3-0.6 %; the tests bound the bias of this one.
KltResult trackPatch(const ImagePyramid& before, const ImagePyramid& after, const Eigen::Vector2d& from,
                     const Eigen::Vector2d& guess, int levels, const TrackingSettings& settings);

}  // namespace cartvo
