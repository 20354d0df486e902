#pragma once

#include <vector>

namespace cartvo::calibrate {

/// A measurement y at x, and when it was taken: what is taken within the same second errs together.
struct TimedSample {
  double seconds = 0.0;
  double x = 0.0, y = 0.0;
};

/// y = intercept + slope x.
struct RobustLine {
  double intercept = 0.0, slope = 0.0;
  double intercept_deviation = 0.0;
  double slope_deviation = 0.0;  ///< infinite if the slope was held

  double error(const TimedSample& sample) const { return sample.y - intercept - slope * sample.x; }
};

/// Fits a line by iteratively reweighted least squares with Cauchy's weights (P. W. Holland, R. E. Welsch,
/// "Robust regression using iteratively reweighted least-squares", 1977). The slope is held at `slope` where
/// x spreads by less than `least_spread` (standard deviation, by the median absolute deviation). Deviations
/// are from the scatter of the seconds' medians. At least one sample.
RobustLine fitRobustLine(const std::vector<TimedSample>& samples, double slope, double least_spread);

/// Standard deviation of normal values by their median absolute deviation.
double robustDeviation(const std::vector<double>& values);

}  // namespace cartvo::calibrate
