#pragma once

namespace cartvo::calib {

// Arc tangent and tangent with bit-identical results on every machine. Those of the C library differ in the
// last bits; these use only additions, multiplications, divisions and square roots, which IEEE 754 defines to
// the last bit.

/// The arc tangent of x >= 0, rad. Relative error below 4e-15.
double portableArcTangent(double x);

/// The tangent of an angle from 0 to 1.56 rad. Relative error below 1e-13 up to 1.5 rad.
double portableTangent(double angle);

}  // namespace cartvo::calib
