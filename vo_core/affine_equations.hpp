#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "vo_core/affine_sums.hpp"
#include "vo_core/aligned_template.hpp"
#include "vo_core/double_lanes.hpp"
#include "vo_core/small_inverse.hpp"

// The equations of four affine alignments, a lane each: what follows from one sum to the next takes long and
// keeps the processor waiting, for four no longer than for one. Not for use outside them.

namespace cartvo {

constexpr double kMaximumStretch = 0.6;  ///< of any element of the warp against the identity
constexpr double kMaximumMove = 3.0;     ///< px from the start

/// Four warps from offsets before to offsets after, and where they put the patches' centres, px.
struct FourWarps {
  Column x, y, xx, xy, yx, yy;

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

/// Where four patches may be.
struct WarpBounds {
  Column start_x, start_y;  ///< px
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

/// How four patches after compare with their templates.
struct FourComparisons {
  Column mean;  ///< of the patch after, less the template's
  Column gain;  ///< against the template
  Column correlation;
  DoubleLanes right_side[kWarpParameters];  ///< of the normal equations
};

/// Of four templates' alignments by the first so many Parameters: shift x, y, then the warp's elements xx,
/// xy, yx, yy, scaled by the patch's half side so that all are pixels. From all derivatives the mean is
/// removed: brightness does not matter.
template <int Parameters>
class AlignmentEquations {
 public:
  /// Lanes are `regular` whose texture holds the warp.
  void setUp(const TemplateSums<OfFourPatches>& sums, MaskLanes& regular) {
    const GradientMoments<OfFourPatches>&p = sums.xx, &q = sums.xy, &r = sums.yy;
    DoubleLanes hessian[kWarpParameters][kWarpParameters] = {
        {p.one, q.one, p.x, p.y, q.x, q.y}, {q.one, r.one, q.x, q.y, r.x, r.y},
        {p.x, q.x, p.xx, p.xy, q.xx, q.xy}, {p.y, q.y, p.xy, p.yy, q.xy, q.yy},
        {q.x, r.x, q.xx, q.xy, r.xx, r.xy}, {q.y, r.y, q.xy, q.yy, r.xy, r.yy}};
#pragma GCC unroll 6
    for (int i = 0; i < Parameters; ++i) {
      slope_sums_[i] = sums.slopes[i];
      slope_greys_[i] = sums.slope_greys[i];
#pragma GCC unroll 6
      for (int j = 0; j <= i; ++j)
        hessian[i][j] -= sums.slopes[i] * (kPerPixel * sums.slopes[j]);
    }
    invertCorner<Parameters>(hessian, kMinimumPivot, inverse_, regular);
    norm_ = sums.squares;
    takeRoots(norm_);
  }

  /// The patch's gain is taken out, else a darker image would shorten each step.
  void compare(const ComparisonSums<OfFourPatches>& sums, FourComparisons& out) const {
    const DoubleLanes mean = sums.values * kPerPixel;
    DoubleLanes deviation = sums.squares - kAlignedSize * mean * mean;
    raiseTo(1e-6, deviation);
    takeRoots(deviation);
    DoubleLanes gain = sums.products / (norm_ * norm_ + 1e-12);
    raiseTo(kMinimumGain, gain);
    const DoubleLanes per_gain = 1.0 / gain;
#pragma GCC unroll 6
    for (int i = 0; i < Parameters; ++i)
      out.right_side[i] = (sums.slopes[i] - mean * slope_sums_[i]) * per_gain - slope_greys_[i];
    out.mean.lanes() = mean;
    out.gain.lanes() = gain;
    out.correlation.lanes() = sums.products / (norm_ * deviation + 1e-12);
  }

  /// Moves the warps `moving` by a Gauss-Newton step. Steps are `settled` that are too short for another to
  /// be worth it.
  void improve(const FourComparisons& at, double convergence, const MaskLanes& moving, FourWarps& warps,
               MaskLanes& settled) const {
    DoubleLanes step[kWarpParameters] = {};
#pragma GCC unroll 6
    for (int i = 0; i < Parameters; ++i) {
      step[i] = inverse_[i][0] * at.right_side[0];
#pragma GCC unroll 6
      for (int j = 1; j < Parameters; ++j)
        step[i] += inverse_[i][j] * at.right_side[j];
    }
    moveBack(step, moving, warps);
    findSettled(step, convergence, settled);
  }

  /// px^2, of the positions (AffineAlignment::variance).
  void findVariances(const FourComparisons& at, Column& x, Column& y) const {
    // What is left of the template, in its own grey values, by what it correlates with the patch after.
    DoubleLanes left = 1.0 / (at.correlation.lanes() * at.correlation.lanes()) - 1.0;
    raiseTo(0.0, left);
    const DoubleLanes square = norm_ * norm_ * left / (kAlignedSize - Parameters);
    x.lanes() = square * inverse_[0][0];
    y.lanes() = square * inverse_[1][1];
  }

 private:
  static constexpr double kMinimumGain = 0.05;
  static constexpr double kMinimumPivot = 1e-4;            // relative, of the normal matrix
  static constexpr double kPerPixel = 1.0 / kAlignedSize;  // dividing takes long, and much waits for it
  static constexpr double kPerHalfSide = 2.0 / kPatchSide;
  static constexpr double kShiftShare = 0.5, kStretchShare = 3.0;  // of the step that ends the iterations

  /// By the inverses of the steps' warps.
  static void moveBack(const DoubleLanes* step, const MaskLanes& moving, FourWarps& warps) {
    const DoubleLanes a = 1.0 + kPerHalfSide * step[2], b = kPerHalfSide * step[3],
                      c = kPerHalfSide * step[4], d = 1.0 + kPerHalfSide * step[5];
    const DoubleLanes per_determinant = 1.0 / (a * d - c * b);
    const DoubleLanes xx = d * per_determinant, xy = -b * per_determinant, yx = -c * per_determinant,
                      yy = a * per_determinant;
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

  /// What stretches the patch moves its edge and not its centre, so that less is asked of it.
  static void findSettled(const DoubleLanes* step, double convergence, MaskLanes& settled) {
    const double shift = kShiftShare * convergence, stretch = kStretchShare * convergence;
    const DoubleLanes shifted = step[0] * step[0] + step[1] * step[1];
    const DoubleLanes stretched =
        (step[2] * step[2] + step[4] * step[4]) + (step[3] * step[3] + step[5] * step[5]);
    settled = (shifted < shift * shift) & (stretched < stretch * stretch);
  }

  DoubleLanes inverse_[kWarpParameters][kWarpParameters];  // of the Gauss-Newton matrix
  DoubleLanes slope_sums_[kWarpParameters], slope_greys_[kWarpParameters];
  DoubleLanes norm_;  // of grey
};

inline void solveShift(const ShiftSums<OfFourPatches>& sums, DoubleLanes& x, DoubleLanes& y) {
  const DoubleLanes determinant = sums.xx * sums.yy - sums.xy * sums.xy;
  x = (sums.yy * sums.x - sums.xy * sums.y) / determinant;
  y = (sums.xx * sums.y - sums.xy * sums.x) / determinant;
}

/// px between the shift that the templates' gradients ask for and that by the gradients of the patches after:
/// backwards, from the patch after to the template, one would miss the start by so much; at most
/// kMaximumMove.
inline void returnMisses(const ReturnSums<OfFourPatches>& sums, const Column& gain, Column& misses) {
  DoubleLanes backward_x, backward_y, forward_x, forward_y;
  solveShift(sums.backward, backward_x, backward_y);
  solveShift(sums.forward, forward_x, forward_y);
  const DoubleLanes x = 2.0 * backward_x - forward_x / gain.lanes();
  const DoubleLanes y = 2.0 * backward_y - forward_y / gain.lanes();
  misses.lanes() = x * x + y * y;
  takeRoots(misses.lanes());
  for (double& miss : misses.value)
    miss = miss < kMaximumMove ? miss : kMaximumMove;  // nor is it any number, if nothing is seen
}

}  // namespace cartvo
