#pragma once

#include <array>
#include <cstring>

#include "vo_core/affine_alignment.hpp"
#include "vo_core/double_lanes.hpp"
#include "vo_core/lanes.hpp"

// What an affine alignment needs to know of its patches. Not for use outside it.

namespace cartvo {

/// Of the patch each other row is compared, which halves the work: neighbouring rows tell much the same.
constexpr int kAlignedRowStep = 2;
constexpr int kAlignedRows = (kPatchSide + kAlignedRowStep - 1) / kAlignedRowStep;
constexpr int kAlignedSize = kPatchSide * kAlignedRows;  ///< px

constexpr int kWarpParameters = 6;        ///< shift x, y, then the warp's elements xx, xy, yx, yy
constexpr int kStereoWarpParameters = 4;  ///< the first four of the six

// What is summed over a patch: first of each of its columns by itself, then of the patch, then of four
// patches, a lane each. All are lists of numbers and nothing else.
struct OfColumns {
  using Number = Lanes;
};
struct OfPatch {
  using Number = double;
};
struct OfFourPatches {
  using Number = DoubleLanes;
};

/// Sums of a product of two gradients times 1, x, y, x^2, x y, y^2, x and y being scaled offsets.
template <typename Of>
struct GradientMoments {
  typename Of::Number one, x, y, xx, xy, yy;
};

template <typename Of>
struct TemplateSums {
  GradientMoments<Of> xx, xy, yy;
  typename Of::Number slopes[kWarpParameters];       ///< derivatives by the parameters
  typename Of::Number slope_greys[kWarpParameters];  ///< the same times grey
  typename Of::Number squares;                       ///< of grey
  typename Of::Number unused;
};

template <typename Of>
struct ComparisonSums {
  typename Of::Number values, squares;          ///< of the patch after
  typename Of::Number products;                 ///< of it and the template
  typename Of::Number slopes[kWarpParameters];  ///< of it and the derivatives
  typename Of::Number unused[3];
};

/// Of the equations of a mere shift.
template <typename Of>
struct ShiftSums {
  typename Of::Number xx, xy, yy, x, y;
};
template <typename Of>
struct ReturnSums {
  ShiftSums<Of> backward, forward;
  typename Of::Number unused[2];
};

template <template <typename> typename Sums>
constexpr int kSumCount = static_cast<int>(sizeof(Sums<OfPatch>) / sizeof(double));

template <template <typename> typename Sums>
void foldColumns(const Sums<OfColumns>& columns, Sums<OfPatch>& sums) {
  static_assert(kSumCount<Sums> % 4 == 0);
  const Lanes* const from = reinterpret_cast<const Lanes*>(&columns);
  double* const to = reinterpret_cast<double*>(&sums);
#pragma GCC unroll 8
  for (int i = 0; i < kSumCount<Sums>; i += 4)
    sumsOf(from[i], from[i + 1], from[i + 2], from[i + 3], to + i);
}

template <template <typename> typename Sums>
void gatherLanes(const std::array<Sums<OfPatch>, kDoubleLanes>& sums, Sums<OfFourPatches>& lanes) {
  static_assert(kSumCount<Sums> % kDoubleLanes == 0);
  DoubleLanes* const to = reinterpret_cast<DoubleLanes*>(&lanes);
#pragma GCC unroll 8
  for (int i = 0; i < kSumCount<Sums>; i += kDoubleLanes) {
    DoubleLanes rows[kDoubleLanes];
#pragma GCC unroll 4
    for (int lane = 0; lane < kDoubleLanes; ++lane)
      std::memcpy(&rows[lane], reinterpret_cast<const double*>(&sums[lane]) + i, sizeof rows[lane]);
    transpose(rows, to + i);
  }
}

}  // namespace cartvo
