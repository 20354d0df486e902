#pragma once

#include <vector>

namespace cartvo::calibrate {

/// A measurement y at x and its time. The errors of measurements within the same second count as correlated.
struct TimedSample {
  double seconds = 0.0;
  double x = 0.0, y = 0.0;
};

/// The line y = intercept + slope x, with standard deviations.
struct RobustLine {
  double intercept = 0.0, slope = 0.0;
  double intercept_stddev = 0.0;
  double slope_stddev = 0.0;  ///< infinite if the slope was fixed

  double error(const TimedSample& sample) const { return sample.y - intercept - slope * sample.x; }
};

/// Fits a line by iteratively reweighted least squares with Cauchy's weights (P. W. Holland, R. E. Welsch,
/// "Robust regression using iteratively reweighted least-squares", 1977). The slope is fixed at `slope` if
/// the standard deviation of x (see robustStddev) is below `min_spread`. Standard deviations come from the
/// scatter of the medians of each second. Requires at least one sample.
RobustLine fitRobustLine(const std::vector<TimedSample>& samples, double slope, double min_spread);

/// Standard deviation of normal values, from their median absolute deviation.
double robustStddev(const std::vector<double>& values);

}  // namespace cartvo::calibrate
