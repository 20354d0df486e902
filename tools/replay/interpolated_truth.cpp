// Interpolates a true trajectory.
#include "tools/replay/interpolated_truth.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <vector>

#include "common/statistics.hpp"

namespace cartvo {
namespace {

/// Bounds of the widest gap. Milliseconds that were read as seconds leave longer ones.
constexpr std::int64_t kMaxGap_ns = 250'000'000, kMaxGapOfSlowTruth_ns = 6'000'000'000;

/// Before the first or behind the last pose: times in a camera's 90 kHz clock are rounded by some us.
constexpr std::int64_t kEndTolerance_ns = 1'000'000;

/// Median time between the poses, ns; 0 for a single one.
std::int64_t medianPeriod(const Trajectory& truth) {
  std::vector<std::int64_t> periods;
  for (std::size_t i = 1; i < truth.size(); ++i)
    periods.push_back(truth[i].time_ns - truth[i - 1].time_ns);
  return periods.empty() ? 0 : median(periods);
}

Eigen::Isometry3d interpolate(const StampedPose& before, const StampedPose& after, std::int64_t time_ns) {
  const double share =
      static_cast<double>(time_ns - before.time_ns) / static_cast<double>(after.time_ns - before.time_ns);
  const Eigen::Quaterniond from(before.pose.linear()), to(after.pose.linear());
  Eigen::Isometry3d between = Eigen::Isometry3d::Identity();
  between.translation() = (1.0 - share) * before.pose.translation() + share * after.pose.translation();
  between.linear() = from.slerp(share, to).toRotationMatrix();
  return between;
}

}  // namespace

InterpolatedTruth::InterpolatedTruth(const Trajectory& truth)
    : truth_(truth), max_gap_ns_(std::clamp(3 * medianPeriod(truth), kMaxGap_ns, kMaxGapOfSlowTruth_ns)) {}

std::optional<Eigen::Isometry3d> InterpolatedTruth::at(std::int64_t time_ns) const {
  const std::int64_t inside_ns = std::clamp(time_ns, truth_.front().time_ns, truth_.back().time_ns);
  if (std::abs(time_ns - inside_ns) > kEndTolerance_ns) return std::nullopt;
  const auto after = std::lower_bound(
      truth_.begin(), truth_.end(), inside_ns,
      [](const StampedPose& true_pose, std::int64_t instant_ns) { return true_pose.time_ns < instant_ns; });
  if (after->time_ns == inside_ns) return after->pose;
  if (after->time_ns - std::prev(after)->time_ns > max_gap_ns_) return std::nullopt;
  return interpolate(*std::prev(after), *after, inside_ns);
}

}  // namespace cartvo
