#pragma once

namespace cartvo::vo {

/// Offset of a correlation peak from the middle sample, in [-0.5, 0.5], and its height: from a sinusoid A
/// cos(w x + p) through the values at -1, 0, +1 (the thesis' sinusoidal sub-pixel fit): w = acos((left +
/// right) / (2 middle)), p = atan((left - right) / (2 middle sin w)), offset = -p / w, height A = middle /
/// cos(p). `middle` must be positive and no less than its neighbours; where no sinusoid fits, the middle is
/// the peak. The height is much faster to compute.
double sinusoidalOffset(double left, double middle, double right);
double sinusoidalHeight(double left, double middle, double right);

}  // namespace cartvo::vo
