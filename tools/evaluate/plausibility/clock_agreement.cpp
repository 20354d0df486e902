// Finds a time offset between an estimate and its truth by the correlation of speeds and rates.
#include "tools/evaluate/plausibility/clock_agreement.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/evaluate/association.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {
namespace {

/// Speed and rates at a fixed rate, in units of what a drive shows at least, without their mean; 0 where they
/// are unknown. Neither depends on the world frame.
using Profile = Eigen::Matrix4Xd;

constexpr double kSpeedUnit = 0.2, kRateUnit = 0.02;  // m/s, rad/s
constexpr double kMinCorrelation = 0.8;
constexpr double kMinOffset = 0.2;  // s

std::int64_t nanoseconds(double time) {
  return std::llround(1e9 * time);
}

double duration(const Trajectory& trajectory) {
  return seconds(trajectory.back().time_ns - trajectory.front().time_ns);
}

Profile profileOf(const Trajectory& trajectory, double step) {
  const InterpolatedTruth poses(trajectory);
  const double window = std::max(2.0 * step, 2.0 * seconds(poses.period_ns()));
  const auto count = static_cast<Eigen::Index>(duration(trajectory) / step) + 1;
  Profile profile = Profile::Zero(4, count);
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::int64_t time_ns = trajectory.front().time_ns + nanoseconds(static_cast<double>(i) * step);
    const std::optional<StampedPose> from = poses.at(time_ns - nanoseconds(0.5 * window)),
                                     to = poses.at(time_ns + nanoseconds(0.5 * window));
    if (!from || !to) continue;
    const vo::Vector6d motion = vo::vectorFromMotion(from->pose.inverse() * to->pose) / window;
    profile.col(i) << motion.head<3>().norm() / kSpeedUnit, motion.tail<3>() / kRateUnit;
    known.push_back(i);
  }
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  for (const Eigen::Index i : known)
    mean += profile.col(i) / static_cast<double>(known.size());
  for (const Eigen::Index i : known)
    profile.col(i) -= mean;
  return profile;
}

/// The rates by their size, which does not depend on the axes either.
Profile withoutAxes(const Profile& profile) {
  Profile sizes = Profile::Zero(4, profile.cols());
  sizes.row(0) = profile.row(0);
  sizes.row(1) = profile.bottomRows<3>().colwise().norm();
  sizes.row(1).array() -= sizes.row(1).mean();
  return sizes;
}

/// Correlation of the truth with the estimate shifted by `lag` steps; -1 with too little in common.
double correlation(const Profile& estimate, const Profile& truth, Eigen::Index lag, Eigen::Index min_common) {
  const Eigen::Index first = std::max<Eigen::Index>(lag, 0);
  const Eigen::Index common = std::min(estimate.cols() + lag, truth.cols()) - first;
  if (common < min_common) return -1.0;
  const auto of_estimate = estimate.middleCols(first - lag, common),
             of_truth = truth.middleCols(first, common);
  const double squares = std::sqrt(of_estimate.squaredNorm() * of_truth.squaredNorm());
  if (squares < static_cast<double>(common)) return -1.0;  // uniform motion
  return of_estimate.cwiseProduct(of_truth).sum() / squares;
}

struct Agreement {
  double offset = 0.0;        ///< s, added to the estimate's instants
  double correlation = -1.0;  ///< with it
  double present = -1.0;      ///< without it
};

/// The best offset. Of maxima that are equal, as of periodic motions, the smallest one, or without a common
/// time that with the most in common.
Agreement bestAgreement(const Profile& estimate, const Profile& truth, double step, double start) {
  const Eigen::Index present = std::lround(std::clamp(start / step, -1e9, 1e9));
  const Eigen::Index shorter = std::min(estimate.cols(), truth.cols());
  const Eigen::Index from = -estimate.cols(), to = truth.cols();
  const bool has_common = present > from && present < to;
  std::vector<double> at(static_cast<std::size_t>(to - from + 1));
  for (Eigen::Index lag = from; lag <= to; ++lag)
    at[static_cast<std::size_t>(lag - from)] =
        correlation(estimate, truth, lag, std::max<Eigen::Index>(shorter / 2, 2));
  const double best = *std::max_element(at.begin(), at.end());
  constexpr double kEqual = 0.01;
  const auto common = [&](Eigen::Index lag) {
    return std::min(estimate.cols() + lag, truth.cols()) - std::max<Eigen::Index>(lag, 0);
  };
  std::optional<Eigen::Index> chosen;
  for (Eigen::Index lag = from + 1; lag < to; ++lag) {
    const auto i = static_cast<std::size_t>(lag - from);
    if (at[i] < best - kEqual || at[i] < at[i - 1] || at[i] < at[i + 1]) continue;
    const bool is_better = !chosen || (has_common ? std::abs(lag - present) < std::abs(*chosen - present)
                                                  : common(lag) > common(*chosen));
    if (is_better) chosen = lag;
  }
  if (!chosen) return {};
  const auto i = static_cast<std::size_t>(*chosen - from);
  const double curvature = at[i - 1] - 2.0 * at[i] + at[i + 1];
  const double part = curvature < 0.0 ? 0.5 * (at[i - 1] - at[i + 1]) / curvature : 0.0;
  const double offset = (static_cast<double>(*chosen) + std::clamp(part, -0.5, 0.5)) * step - start;
  constexpr Eigen::Index kMinPresent = 10;
  return {offset, at[i], has_common ? correlation(estimate, truth, present, kMinPresent) : -1.0};
}

/// Why clocks may differ by an offset (s).
std::string reasonOf(double offset) {
  constexpr double kGpsEpoch = 315'964'800.0;          // since 1970
  constexpr double kGpsFirst = 12.5, kGpsLast = 18.5;  // ahead of UTC since 1999
  const double size = std::abs(offset);
  const auto is_gps = [](double value) { return value > kGpsFirst && value < kGpsLast; };
  if (is_gps(size)) return "GPS time is ahead of UTC, by 18 s since 2017";
  if (is_gps(kGpsEpoch - size)) return "GPS time counts from 1980, and is ahead of UTC";
  if (std::abs(size - kGpsEpoch) < 2.0) return "one counts from 1980, as GPS does, the other from 1970";
  if (std::abs(size - 37.0) < 0.5) return "TAI is 37 s ahead of UTC";
  constexpr double kQuarter = 900.0, kMaxZone = 14.0 * 3600.0;
  const bool is_zone =
      size > kQuarter - 2.0 && size < kMaxZone + 2.0 && std::abs(std::remainder(size, kQuarter)) < 2.0;
  if (is_zone) return "this is the difference of a time zone";
  return "the two clocks differ";
}

}  // namespace

std::string clockProblem(const Trajectory& estimate, const Trajectory& truth) {
  constexpr double kMinStep = 0.1, kMaxSteps = 8000.0;
  const double step = std::max(kMinStep, std::max(duration(estimate), duration(truth)) / kMaxSteps);
  const Profile of_estimate = profileOf(estimate, step), of_truth = profileOf(truth, step);
  const double start = seconds(estimate.front().time_ns - truth.front().time_ns);
  const Agreement without_axes = bestAgreement(withoutAxes(of_estimate), withoutAxes(of_truth), step, start);
  Agreement found = bestAgreement(of_estimate, of_truth, step, start);
  if (found.correlation < kMinCorrelation) found = without_axes;
  found.present = std::max(found.present, without_axes.present);  // turned axes are no matter of the clock
  constexpr double kAllowance = 0.002, kFactor = 3.0;             // of the present disagreement
  const bool is_significant = found.correlation >= kMinCorrelation && std::abs(found.offset) >= kMinOffset &&
                              1.0 - found.present > kAllowance + kFactor * (1.0 - found.correlation);
  if (!is_significant) return {};
  constexpr double kWhole = 0.05;  // s; the conventions of clocks differ by whole seconds
  if (std::abs(found.offset - std::round(found.offset)) < kWhole) found.offset = std::round(found.offset);
  const std::string present = found.present <= -1.0 ? "" : fmt::format(", without {:.4f}", found.present);
  return fmt::format(
      "the clocks of the two files differ: speeds and rates agree with {:+.2f} s added to the estimate's "
      "instants "
      "(correlation {:.4f}{}): {}; compare with --offset {:.2f}",
      found.offset, found.correlation, present, reasonOf(found.offset), found.offset);
}

}  // namespace cartvo
