#pragma once

#include <Eigen/Core>

#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"

// KLT tracking of one patch: a pyramidal shift, then an affine alignment.

namespace cartvo::vo {

/// Result of trackPatch().
struct KltResult {
  bool found = false;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< px, in the image after
  double correlation = 0.0;  ///< normalised cross-correlation of the patches before and after
};

/// Tracks the 15x15 patch around `from` in `before` to `after`, starting at `guess` (px): a shift
/// (trackShift) in `levels` pyramid levels, coarse to fine, then an affine alignment (alignAffine). Not
/// found: the patch has no texture, leaves the image, or correlates less than settings.minimum_correlation.
/// Pixels are interpolated exactly and equations solved in floating point: OpenCV's fixed-point KLT
/// underestimates flow by 0.3-0.6 %; the tests bound the bias of this one.
KltResult trackPatch(const ImagePyramid& before, const ImagePyramid& after, const Eigen::Vector2d& from,
                     const Eigen::Vector2d& guess, int levels, const TrackingSettings& settings);

}  // namespace cartvo::vo
