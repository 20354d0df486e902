#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "vo_core/image/aligned_patch.hpp"
#include "vo_core/image/patch_sums.hpp"
#include "vo_core/simd/double_lanes.hpp"
#include "vo_core/simd/small_inverse.hpp"

// Gauss-Newton equations of four affine alignments, one SIMD lane each. The template is the patch of the
// first image, the patch after that of the second. Each operation of an alignment waits for the one before,
// so that four alignments together take no longer than one. Internal to affine_alignment.cpp.

namespace cartvo::vo {

constexpr double kMaximumStretch = 0.6;  ///< largest difference of a warp element from the identity
constexpr double kMaximumMove = 3.0;     ///< px, largest distance from the start

/// Four warps (offsets before to offsets after) and the positions of the patch centres, px.
struct FourWarps {
  LaneValues x, y, xx, xy, yx, yy;

  Eigen::Vector2d position(std::size_t i) const { return {x.value[i], y.value[i]}; }
  Eigen::Matrix2d warp(std::size_t i) const {
    Eigen::Matrix2d warp;
    warp << xx.value[i], xy.value[i], yx.value[i], yy.value[i];
    return warp;
  }
  void set(std::size_t i, const Eigen::Vector2d& position, const Eigen::Matrix2d& warp) {
    x.value[i] = position.x();
    y.value[i] = position.y();
    xx.value[i] = warp(0, 0);
    xy.value[i] = warp(0, 1);
    yx.value[i] = warp(1, 0);
    yy.value[i] = warp(1, 1);
  }
};

/// Limits of the positions and warps of four patches.
struct WarpBounds {
  LaneValues start_x, start_y;  ///< px
  LevelBounds level;

  void findInside(const FourWarps& warps, MaskLanes& inside) const {
    level.findInside(warps.x, warps.y, inside);
    const DoubleLanes move_x = warps.x.lanes() - start_x.lanes(), move_y = warps.y.lanes() - start_y.lanes();
    inside &= move_x * move_x + move_y * move_y <= kMaximumMove * kMaximumMove;
    bound(warps.xx.lanes() - 1.0, inside);
    bound(warps.xy.lanes(), inside);
    bound(warps.yx.lanes(), inside);
    bound(warps.yy.lanes() - 1.0, inside);
  }

 private:
  static void bound(const DoubleLanes& stretch, MaskLanes& inside) {
    inside &= (stretch <= kMaximumStretch) & (stretch >= -kMaximumStretch);
  }
};

/// Result of comparing four patches of the second image with their templates.
struct FourComparisons {
  LaneValues mean;  ///< mean of the patch after
  LaneValues gain;  ///< gain of the patch after relative to the template
  LaneValues correlation;
  DoubleLanes right_side[kAffineParameters];  ///< of the normal equations
};

/// Normal equations of four alignments in the shift x, y and the warp elements xx, xy, yx, yy, scaled by half
/// the patch side so that all are in px. The mean is removed from every sum, so that brightness does not
/// matter; this rounds nothing, because the sums are exact.
class AlignmentEquations {
 public:
  /// Sets up the templates. `regular`: lanes whose texture constrains the warp.
  void setUp(const SumsOfFour<TemplateSums<kAffineParameters>>& sums, MaskLanes& regular) {
    using Sums = TemplateSums<kAffineParameters>;
    mean_ = kPerPixel * sums[Sums::kGreys];
    DoubleLanes normal[kAffineParameters][kAffineParameters];
#pragma GCC unroll 6
    for (int i = 0; i < kAffineParameters; ++i) {
      slopes_[i] = sums[Sums::slope(i)];
      slope_greys_[i] = sums[Sums::slopeGrey(i)] - mean_ * slopes_[i];
#pragma GCC unroll 6
      for (int j = 0; j <= i; ++j)
        normal[i][j] = sums[Sums::normal(i, j)] - slopes_[i] * (kPerPixel * slopes_[j]);
    }
    invertCorner<kAffineParameters>(normal, kMinimumPivot, inverse_, regular);
    greys_ = sums[Sums::kGreys];
    norm_ = sums[Sums::kSquares] - mean_ * greys_;
    replaceBySquareRoots(norm_);
  }

  /// Compares the patches of the second image with the templates. The gain is divided out; otherwise a darker
  /// image would shorten each step.
  void compare(const SumsOfFour<ComparisonSums<kAffineParameters>>& sums, FourComparisons& out) const {
    using Sums = ComparisonSums<kAffineParameters>;
    const DoubleLanes mean = kPerPixel * sums[Sums::kValues];
    DoubleLanes deviation = sums[Sums::kSquares] - mean * sums[Sums::kValues];
    clampToMinimum(1e-6, deviation);
    replaceBySquareRoots(deviation);
    const DoubleLanes product = sums[Sums::kWithGrey] - mean * greys_;
    DoubleLanes gain = product / (norm_ * norm_ + 1e-12);
    clampToMinimum(kMinimumGain, gain);
    const DoubleLanes per_gain = 1.0 / gain;
#pragma GCC unroll 6
    for (int i = 0; i < kAffineParameters; ++i)
      out.right_side[i] = (sums[Sums::slope(i)] - mean * slopes_[i]) * per_gain - slope_greys_[i];
    out.mean.lanes() = mean;
    out.gain.lanes() = gain;
    out.correlation.lanes() = product / (norm_ * deviation + 1e-12);
  }

  /// Applies a Gauss-Newton step to the lanes `moving`. `converged`: lanes whose step is too short for
  /// another iteration.
  void applyStep(const FourComparisons& at, double convergence, const MaskLanes& moving, FourWarps& warps,
                 MaskLanes& converged) const {
    DoubleLanes step[kAffineParameters];
#pragma GCC unroll 6
    for (int i = 0; i < kAffineParameters; ++i) {
      step[i] = inverse_[i][0] * at.right_side[0];
#pragma GCC unroll 6
      for (int j = 1; j < kAffineParameters; ++j)
        step[i] += inverse_[i][j] * at.right_side[j];
    }
    composeInverse(step, moving, warps);
    findConverged(step, convergence, converged);
  }

  /// Mean grey values of the templates.
  const DoubleLanes& mean() const {
    return mean_;
  }

  /// Variances of the positions, px^2 (AffineAlignment::variance).
  void findVariances(const FourComparisons& at, LaneValues& x, LaneValues& y) const {
    // Residual relative to the grey values of the template, from its correlation with the patch after.
    DoubleLanes left = 1.0 / (at.correlation.lanes() * at.correlation.lanes()) - 1.0;
    clampToMinimum(0.0, left);
    const DoubleLanes square = norm_ * norm_ * left / (kAlignedSize - kAffineParameters);
    x.lanes() = square * inverse_[0][0];
    y.lanes() = square * inverse_[1][1];
  }

 private:
  static constexpr double kMinimumGain = 0.05;
  static constexpr double kMinimumPivot = 1e-4;  // of the normal matrix, relative to the largest pivot
  static constexpr double kPerPixel =
      1.0 / kAlignedSize;  // as a factor: division is slow and on the critical path
  static constexpr double kPerHalfSide = 2.0 / kPatchSide;
  static constexpr double kShiftShare = 0.5,
                          kStretchShare = 3.0;  // times `convergence`: limits of a converged step

  /// Composes the warps with the inverses of the steps' warps.
  static void composeInverse(const DoubleLanes* step, const MaskLanes& moving, FourWarps& warps) {
    const DoubleLanes a = 1.0 + kPerHalfSide * step[2], b = kPerHalfSide * step[3];
    const DoubleLanes c = kPerHalfSide * step[4], d = 1.0 + kPerHalfSide * step[5];
    const DoubleLanes per_determinant = 1.0 / (a * d - c * b);
    const DoubleLanes xx = d * per_determinant, xy = -b * per_determinant;
    const DoubleLanes yx = -c * per_determinant, yy = a * per_determinant;
    const DoubleLanes new_xx = warps.xx.lanes() * xx + warps.xy.lanes() * yx;
    const DoubleLanes new_xy = warps.xx.lanes() * xy + warps.xy.lanes() * yy;
    const DoubleLanes new_yx = warps.yx.lanes() * xx + warps.yy.lanes() * yx;
    const DoubleLanes new_yy = warps.yx.lanes() * xy + warps.yy.lanes() * yy;
    warps.xx.replace(moving, new_xx);
    warps.xy.replace(moving, new_xy);
    warps.yx.replace(moving, new_yx);
    warps.yy.replace(moving, new_yy);
    warps.x.replace(moving, warps.x.lanes() - (new_xx * step[0] + new_xy * step[1]));
    warps.y.replace(moving, warps.y.lanes() - (new_yx * step[0] + new_yy * step[1]));
  }

  /// A stretch moves the edge of the patch and not its centre, so that its limit is wider.
  static void findConverged(const DoubleLanes* step, double convergence, MaskLanes& converged) {
    const double shift = kShiftShare * convergence, stretch = kStretchShare * convergence;
    const DoubleLanes shifted = step[0] * step[0] + step[1] * step[1];
    const DoubleLanes stretched =
        (step[2] * step[2] + step[4] * step[4]) + (step[3] * step[3] + step[5] * step[5]);
    converged = (shifted < shift * shift) & (stretched < stretch * stretch);
  }

  DoubleLanes inverse_[kAffineParameters][kAffineParameters];  // of the Gauss-Newton matrix
  DoubleLanes slopes_[kAffineParameters];                      // sums of the derivatives
  DoubleLanes slope_greys_[kAffineParameters];                 // sums of derivative times grey less its mean
  DoubleLanes greys_, mean_,
      norm_;  // of the grey values: sum, mean, and norm of their deviations from the mean
};

/// Solves for the shift of four patches by which the gradients account for the grey differences. `sums`: one
/// side of ForwardBackwardSums.
inline void solveShift(const DoubleLanes* sums, const DoubleLanes& mean, const DoubleLanes& gain,
                       const DoubleLanes& grey_mean, DoubleLanes& x, DoubleLanes& y) {
  using Sums = ForwardBackwardSums;
  DoubleLanes error[2];
  for (int axis = 0; axis < 2; ++axis) {
    const DoubleLanes& alone = sums[Sums::kAlone + axis];
    error[axis] =
        (sums[Sums::kNows + axis] - mean * alone) - gain * (sums[Sums::kGreys + axis] - grey_mean * alone);
  }
  const DoubleLanes &xx = sums[Sums::kXx], &xy = sums[Sums::kXy], &yy = sums[Sums::kYy];
  const DoubleLanes determinant = xx * yy - xy * xy;
  x = (yy * error[0] - xy * error[1]) / determinant;
  y = (xx * error[1] - xy * error[0]) / determinant;
}

/// Forward-backward errors of four patches, px, at most kMaximumMove: the distance between the shift by the
/// gradients of the template and the shift by those of the patch after. `grey_mean`: of the templates.
inline void forwardBackwardErrors(const SumsOfFour<ForwardBackwardSums>& sums, const FourComparisons& at,
                                  const DoubleLanes& grey_mean, LaneValues& errors) {
  const DoubleLanes &mean = at.mean.lanes(), &gain = at.gain.lanes();
  DoubleLanes backward_x, backward_y, forward_x, forward_y;
  solveShift(sums.sum, mean, gain, grey_mean, backward_x, backward_y);
  solveShift(sums.sum + ForwardBackwardSums::kOfOne, mean, gain, grey_mean, forward_x, forward_y);
  const DoubleLanes x = backward_x - forward_x / gain;
  const DoubleLanes y = backward_y - forward_y / gain;
  errors.lanes() = x * x + y * y;
  replaceBySquareRoots(errors.lanes());
  for (double& miss : errors.value)
    miss =
        miss < kMaximumMove ? miss : kMaximumMove;  // also replaces NaN, which a patch without texture gives
}

}  // namespace cartvo::vo
