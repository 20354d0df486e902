#pragma once

namespace cartvo {

/// Where the peak of a correlation lies between samples: the offset in (-0.5, 0.5) from the middle one, from
/// a sinusoid A cos(w x + p) through the values at -1, 0, +1 (thesis, sinusoidal sub-pixel fit; the closed
/// form is S. Fertner, A. Sjölund's, "Comparison of various time delay estimation methods", 1986): w =
/// acos((left + right) / (2 middle)), p = atan((left - right) / (2 middle sin w)), offset = -p / w. `middle`
/// must be positive and no less than its neighbours; 0 where no sinusoid fits.
double sinusoidalPeak(double left, double middle, double right);

}  // namespace cartvo
