// Robust fit of a line, with standard deviations.
#include "tools/calibrate/check/robust_line.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/statistics.hpp"

namespace cartvo::calibrate {
namespace {

std::vector<double> errorsOf(const std::vector<TimedSample>& samples, const RobustLine& line) {
  std::vector<double> errors;
  for (const TimedSample& sample : samples)
    errors.push_back(line.error(sample));
  return errors;
}

/// One step of least squares, with the weights of the current line.
void updateLine(const std::vector<TimedSample>& samples, bool is_slope_free, RobustLine& line) {
  constexpr double kCauchy = 2.385, kMinScale = 1e-4;
  const std::vector<double> errors = errorsOf(samples, line);
  const double scale = std::max(kMinScale, kCauchy * robustStddev(errors));
  Eigen::Matrix2d H = 1e-12 * Eigen::Matrix2d::Identity();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector2d terms(1.0, is_slope_free ? samples[i].x : 0.0);
    const double weight = 1.0 / (1.0 + errors[i] * errors[i] / (scale * scale));
    H += weight * terms * terms.transpose();
    g += weight * errors[i] * terms;
  }
  const Eigen::Vector2d step = H.ldlt().solve(g);
  line.intercept += step[0];
  if (is_slope_free) line.slope += step[1];
}

/// The median error of each second.
std::vector<double> secondErrors(const std::vector<TimedSample>& samples, const RobustLine& line) {
  std::map<long, std::vector<double>> seconds;
  for (const TimedSample& sample : samples)
    seconds[static_cast<long>(std::floor(sample.seconds))].push_back(line.error(sample));
  std::vector<double> errors;
  for (const auto& [second, values] : seconds)
    errors.push_back(medianOf(values));
  return errors;
}

}  // namespace

double robustStddev(const std::vector<double>& values) {
  const double centre = medianOf(values);
  std::vector<double> distances;
  for (const double value : values)
    distances.push_back(std::abs(value - centre));
  return 1.4826 * medianOf(distances);
}

RobustLine fitRobustLine(const std::vector<TimedSample>& samples, double slope, double min_spread) {
  constexpr int kIterations = 30;
  std::vector<double> xs;
  for (const TimedSample& sample : samples)
    xs.push_back(sample.x);
  const double spread = robustStddev(xs), middle = medianOf(xs);
  const bool is_slope_free = spread > min_spread;
  RobustLine line;
  line.slope = slope;
  for (int iteration = 0; iteration < kIterations; ++iteration)
    updateLine(samples, is_slope_free, line);
  const std::vector<double> errors = secondErrors(samples, line);
  const double mean_stddev = robustStddev(errors) / std::sqrt(static_cast<double>(errors.size()));
  line.slope_stddev = is_slope_free ? mean_stddev / spread : std::numeric_limits<double>::infinity();
  line.intercept_stddev = is_slope_free ? mean_stddev * std::hypot(1.0, middle / spread) : mean_stddev;
  return line;
}

}  // namespace cartvo::calibrate
