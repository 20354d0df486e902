#pragma once

#include <Eigen/Core>
#include <optional>

#include "vo_core/image_pyramid.hpp"

namespace cartvo {

struct AffineAlignment {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< px, of the patch's centre in the level after
  Eigen::Matrix2d warp = Eigen::Matrix2d::Identity();  ///< from offsets before to offsets after
  double correlation = 0.0;                            ///< normalised, of the patches under the warp
};

/// Aligns the 15x15 patch around `from` in `before` with `after`, beginning at the shift to `start`, under an
/// affine warp and any change of brightness (J. Shi, C. Tomasi, "Good features to track", 1994; inverse
/// compositional). Near the camera a patch of the road grows by a fifth from one image to the next; a mere
/// shift (thesis 4.10) then lands pixels off. Nothing if the texture does not hold a warp, the warp runs away
/// from a plausible one, or the patch from where the shift has put it.
std::optional<AffineAlignment> alignAffine(const PyramidLevel& before, const PyramidLevel& after,
                                           const Eigen::Vector2d& from, const Eigen::Vector2d& start,
                                           int iterations, double convergence);

}  // namespace cartvo
