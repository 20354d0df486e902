// Velocities and rates of a true trajectory by splines.
#include "tools/evaluate/validity/true_twist.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>

#include "tools/evaluate/association.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kMinSpacing_ns = 20'000'000;
constexpr std::int64_t kTolerance_ns = 1'000'000;  // times in a 90 kHz clock are rounded by some us
constexpr std::size_t kMinKnots = 4;               // slopes at the ends are those of a cubic

/// Derivative at the first of four knots of the cubic through them.
double endSlope(const std::array<double, 4>& times, const std::array<double, 4>& values) {
  double slope = 0.0;
  for (std::size_t i = 1; i < 4; ++i) {
    double share = 1.0;
    for (std::size_t j = 1; j < 4; ++j)
      if (j != i) share *= (times[0] - times[j]) / (times[i] - times[j]);
    slope += (share * values[i] - values[0]) / (times[i] - times[0]);
  }
  return slope;
}

/// Slopes of the cubic spline with continuous second derivatives through values at `times`.
std::vector<double> splineSlopes(const std::vector<double>& times, const std::vector<double>& values) {
  const std::size_t n = times.size();
  const auto end_slope = [&](std::size_t at, std::ptrdiff_t step) {
    std::array<double, 4> t{}, v{};
    for (std::size_t i = 0; i < 4; ++i, at += static_cast<std::size_t>(step)) {
      t[i] = times[at];
      v[i] = values[at];
    }
    return endSlope(t, v);
  };
  std::vector<double> slopes(n), upper(n);  // the elimination of a tridiagonal system
  slopes[0] = end_slope(0, 1);
  slopes[n - 1] = end_slope(n - 1, -1);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = times[i] - times[i - 1], after = times[i + 1] - times[i];
    const double right_side =
        3.0 * (after / before * (values[i] - values[i - 1]) + before / after * (values[i + 1] - values[i]));
    const double diagonal = 2.0 * (before + after) - after * upper[i - 1];
    upper[i] = before / diagonal;
    slopes[i] = (right_side - after * slopes[i - 1]) / diagonal;
  }
  for (std::size_t i = n - 1; i-- > 1;)
    slopes[i] -= upper[i] * slopes[i + 1];
  return slopes;
}

}  // namespace

TrueTwist::TrueTwist(const Trajectory& truth) {
  const InterpolatedTruth interpolated(truth);
  std::size_t first = 0;
  for (std::size_t i = 1; i <= truth.size(); ++i) {
    if (i < truth.size() && truth[i].time_ns - truth[i - 1].time_ns <= interpolated.maxGapNs()) continue;
    addPiece(truth, first, i);
    first = i;
  }
}

void TrueTwist::addPiece(const Trajectory& truth, std::size_t first, std::size_t last) {
  std::vector<Knot> knots;
  for (std::size_t i = first; i < last; ++i) {
    if (!knots.empty() && truth[i].time_ns - knots.back().time_ns < kMinSpacing_ns) continue;
    Eigen::Quaterniond rotation(truth[i].pose.linear());
    Knot knot{truth[i].time_ns};
    const Eigen::Vector3d position = truth[i].pose.translation();
    knot.value = {position.x(), position.y(), position.z(), rotation.w(),
                  rotation.x(), rotation.y(), rotation.z()};
    if (!knots.empty()) {  // of q and -q, the one nearer to the quaternion before
      double product = 0.0;
      for (std::size_t k = 3; k < 7; ++k)
        product += knot.value[k] * knots.back().value[k];
      for (std::size_t k = 3; k < 7 && product < 0.0; ++k)
        knot.value[k] *= -1.0;
    }
    knots.push_back(knot);
  }
  if (knots.size() < kMinKnots) return;
  std::vector<double> times, values(knots.size());
  for (const Knot& knot : knots)
    times.push_back(seconds(knot.time_ns - knots.front().time_ns));
  for (std::size_t k = 0; k < 7; ++k) {
    std::transform(knots.begin(), knots.end(), values.begin(),
                   [k](const Knot& knot) { return knot.value[k]; });
    const std::vector<double> slopes = splineSlopes(times, values);
    for (std::size_t i = 0; i < knots.size(); ++i)
      knots[i].slope[k] = slopes[i];
  }
  pieces_.push_back(std::move(knots));
}

std::optional<vo::Vector6d> TrueTwist::at(std::int64_t time_ns) const {
  for (const std::vector<Knot>& knots : pieces_) {
    const std::int64_t inside_ns = std::clamp(time_ns, knots[1].time_ns, knots[knots.size() - 2].time_ns);
    if (std::abs(time_ns - inside_ns) > kTolerance_ns) continue;
    const auto after =
        std::upper_bound(knots.begin(), knots.end() - 1, inside_ns,
                         [](std::int64_t instant, const Knot& knot) { return instant < knot.time_ns; });
    const Knot &a = *std::prev(after), &b = *after;
    const double span = seconds(b.time_ns - a.time_ns), u = seconds(inside_ns - a.time_ns) / span;
    Values value{}, slope{};  // of the cubic with the values and slopes of both knots
    for (std::size_t k = 0; k < 7; ++k) {
      const double rise = b.value[k] - a.value[k], from = span * a.slope[k], to = span * b.slope[k];
      value[k] = a.value[k] + u * from + u * u * (3.0 * rise - 2.0 * from - to) +
                 u * u * u * (from + to - 2.0 * rise);
      slope[k] =
          (from + 2.0 * u * (3.0 * rise - 2.0 * from - to) + 3.0 * u * u * (from + to - 2.0 * rise)) / span;
    }
    const Eigen::Quaterniond q(value[3], value[4], value[5], value[6]),
        rate(slope[3], slope[4], slope[5], slope[6]);
    vo::Vector6d twist;
    twist << q.normalized().conjugate() * Eigen::Vector3d(slope[0], slope[1], slope[2]),
        2.0 / q.squaredNorm() * (q.conjugate() * rate).vec();
    return twist;
  }
  return std::nullopt;
}

}  // namespace cartvo
