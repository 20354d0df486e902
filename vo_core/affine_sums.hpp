#pragma once

#include "vo_core/patch_sums.hpp"

// What an affine alignment needs to know of its patches. Not for use outside it.

namespace cartvo {

constexpr int kWarpParameters = 6;        ///< shift x, y, then the warp's elements xx, xy, yx, yy
constexpr int kStereoWarpParameters = 4;  ///< the first four of the six

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

}  // namespace cartvo
