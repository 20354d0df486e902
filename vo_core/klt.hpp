#pragma once

#include <Eigen/Core>
#include <optional>

#include "vo_core/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

struct KltResult {
  bool found = false;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< px, in the image after
  double correlation = 0.0;                            ///< normalised, of the patch before and after
};

/// Levels of a pyramid, from the finest to the coarsest, both included.
struct PyramidLevels {
  int finest = 0;
  int coarsest = 0;
};

/// The first part of trackPatch: the shift alone, to a tenth of a pixel of the finest level, where the
/// patches must correlate by `minimum_correlation`.
std::optional<Eigen::Vector2d> trackShift(const ImagePyramid& before, const ImagePyramid& after,
                                          const Eigen::Vector2d& from, const Eigen::Vector2d& guess,
                                          const PyramidLevels& levels, double minimum_correlation);

/// Follows the 15x15 patch around `from` in the grey levels of `before` to those of `after`, coarse to fine,
/// beginning at `guess` (px) in the coarsest of `levels` (a good guess needs few). It minimises the sum of
/// squared differences over the shift d (thesis 4.10-4.13: G d = b with the structure matrix G of the patch's
/// gradients), with a change of brightness removed. Not found: no texture, left the image, or correlates less
/// than settings.minimum_correlation.
///
/// The patch before is the one that is linearised (S. Baker, I. Matthews, "Lucas-Kanade 20 years on", 2004,
/// inverse compositional), in floating point throughout. OpenCV's fixed-point KLT underestimates flow by
/// 0.3-0.6 %; the tests bound the bias of this one.
KltResult trackPatch(const ImagePyramid& before, const ImagePyramid& after, const Eigen::Vector2d& from,
                     const Eigen::Vector2d& guess, int levels, const TrackingSettings& settings);

}  // namespace cartvo
