#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "vo_core/image/image_pyramid.hpp"

// Alignment of a patch between two images under an affine warp, with subpixel accuracy.

namespace cartvo::vo {

constexpr int kPatchSide =
    15;  ///< px of the pyramid level that the patch is taken from; side of the square patch

/// Result of an alignment.
struct AffineAlignment {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< px, patch centre in the level `after`
  Eigen::Matrix2d warp =
      Eigen::Matrix2d::Identity();  ///< maps offsets from the patch centre before to those after
  double correlation = 0.0;         ///< normalised cross-correlation of the patches under the warp
  /// px^2, variance of each coordinate of the position: the covariance of the least-squares fit, i.e. the
  /// mean square of the grey differences times the inverse of the normal matrix.
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
  double forward_backward_error = 0.0;  ///< px, forward-backward error: distance by which a step backwards,
                                        ///< linearised at the patch after, misses the start
};

/// Aligns the 15x15 patch around `from` in `before` with `after`, starting at the position and warp of
/// `start`, under a warp and any change of gain and brightness (J. Shi, C. Tomasi, "Good features to track",
/// 1994; inverse compositional). Near the camera a patch of the road grows by a fifth from one image to the
/// next, and its disparity changes by a third of a pixel per row; a pure shift (thesis 4.10) is then off by
/// pixels. Returns nothing if the texture does not constrain the warp, if the warp exceeds its limits, or if
/// the patch moves too far from its start.
std::optional<AffineAlignment> alignAffine(const PyramidLevel& before, const PyramidLevel& after,
                                           const Eigen::Vector2d& from, const AffineAlignment& start,
                                           int iterations, double convergence);

/// One alignment: the patch around `from` in `before` with `after`, starting at `start`.
struct AlignmentTask {
  const PyramidLevel* before = nullptr;
  const PyramidLevel* after = nullptr;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< px
  AffineAlignment start;                           ///< initial position and warp
};

/// Aligns many patches, faster than one by one and with the same results. `aligned` has the size of `tasks`.
void alignAffine(std::span<const AlignmentTask> tasks, int iterations, double convergence,
                 std::span<std::optional<AffineAlignment>> aligned);

}  // namespace cartvo::vo
