#pragma once

namespace cartvo::vo {

/// Variance of the residuals of a landmark, in units of the expected one: running sums of normalised
/// residuals, and as many expected ones as pairs are remembered. So one large residual means little, and
/// several are not taken for chance (a scaled inverse chi-squared prior, whose weights are those of Student's
/// t distribution: K. Lange et al., "Robust statistical modeling using the t distribution", 1989). `pairs`:
/// memory in pairs, see SelfCalibrationSettings::correlated_pairs.
struct ResidualVariance {
  double squares = 0.0, count = 0.0;  ///< sums over the remembered residuals

  void fade(double pairs) {
    const double kept = 1.0 - 1.0 / pairs;
    squares *= kept;
    count *= kept;
  }
  void add(double square) {
    squares += square;
    count += 1.0;
  }
  /// Inverse of the variance; 1 without residuals.
  double weight(double pairs) const { return (count + pairs) / (squares + pairs); }
};

}  // namespace cartvo::vo
