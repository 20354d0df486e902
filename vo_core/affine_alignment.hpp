#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

#include "vo_core/image_pyramid.hpp"

namespace cartvo {

constexpr int kPatchSide = 15;  ///< px of the level that a patch is taken from

struct AffineAlignment {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< px, of the patch's centre in the level after
  Eigen::Matrix2d warp = Eigen::Matrix2d::Identity();  ///< from offsets before to offsets after
  double correlation = 0.0;                            ///< normalised, of the patches under the warp
  /// px^2, of the position in each coordinate, by what the patches differ in and how steep they are: the
  /// least squares' own covariance, their differences' mean square times the inverse of the normal matrix.
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
  double return_miss = 0.0;  ///< px by which a step backwards, the patch after linearised, misses the start
};

/// What the patch may do between two images.
enum class WarpModel : std::uint8_t {
  affine,  ///< from one instant to another: six parameters
  stereo,  ///< from left to right at one instant: rows stay, so only the shift and the slope of the
           ///< disparity, four
};

/// Aligns the 15x15 patch around `from` in `before` with `after`, beginning at `start`'s position and warp,
/// under a warp and any change of gain and brightness (J. Shi, C. Tomasi, "Good features to track", 1994;
/// inverse compositional). Near the camera a patch of the road grows by a fifth from one image to the next,
/// and its disparity changes by a third of a pixel from row to row; a mere shift (thesis 4.10) then lands
/// pixels off. Nothing if the texture does not hold the warp, the warp runs away from a plausible one, or the
/// patch from where it started.
std::optional<AffineAlignment> alignAffine(const PyramidLevel& before, const PyramidLevel& after,
                                           const Eigen::Vector2d& from, const AffineAlignment& start,
                                           WarpModel model, int iterations, double convergence);

/// What is to be aligned: the patch around `from` in `before` with `after`, from `start` on.
struct AlignmentTask {
  const PyramidLevel* before = nullptr;
  const PyramidLevel* after = nullptr;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< px
  AffineAlignment start;                           ///< its position and warp
};

/// The same of many, each as it would be alone, but faster. `aligned`: of the size of `tasks`.
void alignAffine(std::span<const AlignmentTask> tasks, WarpModel model, int iterations, double convergence,
                 std::span<std::optional<AffineAlignment>> aligned);

}  // namespace cartvo
