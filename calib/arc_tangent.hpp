#pragma once

namespace cartvo {

// The mathematical library's functions differ in the last bits between machines. These are made of additions,
// multiplications, divisions and square roots alone, which IEEE 754 defines to the last bit.

/// The arc tangent of x >= 0, rad; within 4e-15 of the true one, relatively.
double portableArcTangent(double x);

/// The tangent of an angle of 0 to 1.56 rad; within 1e-13 of the true one, relatively, up to 1.5 rad.
double portableTangent(double angle);

}  // namespace cartvo
