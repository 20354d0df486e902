#include "tools/evaluate/association.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace cartvo {
namespace {

constexpr std::int64_t kWidestGap = 250'000'000;  // ns

/// Instants that went through a camera's 90 kHz clock are off by some us: so little beyond the truth's first
/// or last pose counts as that pose, ns.
constexpr std::int64_t kEndTolerance = 1'000'000;

/// The widest gap in the truth that is bridged, ns.
std::int64_t bridgedGap(const Trajectory& truth) {
  std::vector<std::int64_t> periods;
  for (std::size_t i = 1; i < truth.size(); ++i)
    periods.push_back(truth[i].time_ns - truth[i - 1].time_ns);
  if (periods.empty()) return kWidestGap;
  std::nth_element(periods.begin(), periods.begin() + periods.size() / 2, periods.end());
  return std::max(kWidestGap, 3 * periods[periods.size() / 2]);
}

StampedPose interpolate(const StampedPose& before, const StampedPose& after, std::int64_t time_ns) {
  const double share =
      static_cast<double>(time_ns - before.time_ns) / static_cast<double>(after.time_ns - before.time_ns);
  StampedPose between;
  between.time_ns = time_ns;
  between.pose.translation() = (1.0 - share) * before.pose.translation() + share * after.pose.translation();
  between.pose.linear() = Eigen::Quaterniond(before.pose.linear())
                              .slerp(share, Eigen::Quaterniond(after.pose.linear()))
                              .toRotationMatrix();
  return between;
}

double seconds(std::int64_t time_ns) {
  return 1e-9 * static_cast<double>(time_ns);
}

std::string span(const Trajectory& trajectory) {
  char text[80];
  std::snprintf(text, sizeof text, "%.3f s to %.3f s", seconds(trajectory.front().time_ns),
                seconds(trajectory.back().time_ns));
  return text;
}

}  // namespace

AssociatedTrajectories associateByTime(const Trajectory& estimate, const Trajectory& truth) {
  AssociatedTrajectories associated;
  associated.method = AssociationMethod::time;
  const std::int64_t widest_gap = bridgedGap(truth);
  for (const StampedPose& stamped : estimate) {
    const std::int64_t time_ns = std::clamp(stamped.time_ns, truth.front().time_ns, truth.back().time_ns);
    const auto after = std::lower_bound(
        truth.begin(), truth.end(), time_ns,
        [](const StampedPose& true_pose, std::int64_t instant_ns) { return true_pose.time_ns < instant_ns; });
    const bool is_exact = after->time_ns == time_ns;
    const bool is_between = !is_exact && after->time_ns - std::prev(after)->time_ns <= widest_gap;
    if (std::abs(stamped.time_ns - time_ns) > kEndTolerance || (!is_exact && !is_between)) {
      ++associated.unmatched;
      continue;
    }
    associated.estimate.push_back(stamped);
    associated.truth.push_back(is_exact ? *after : interpolate(*std::prev(after), *after, time_ns));
  }
  if (associated.estimate.size() < 2) {
    throw std::runtime_error(
        "fewer than two poses of the estimate have a truth of their instant: the estimate is of " +
        span(estimate) + ", the truth of " + span(truth) + "; are both of one clock?");
  }
  return associated;
}

AssociatedTrajectories associateByRows(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.size() != truth.size()) {
    throw std::runtime_error("the estimate has " + std::to_string(estimate.size()) + " poses, the truth " +
                             std::to_string(truth.size()) +
                             "; KITTI rows have no instants, so both files must hold the same frames");
  }
  if (estimate.size() < 2) throw std::runtime_error("one pose is no trajectory: there is nothing to compare");
  return {AssociationMethod::rows, estimate, truth, 0};
}

AssociatedTrajectories associateFiles(const std::filesystem::path& estimate,
                                      const std::filesystem::path& truth) {
  const Trajectory estimated = readTrajectory(estimate), true_poses = readTrajectory(truth);
  const bool has_instants = !isKittiTrajectory(estimate) && !isKittiTrajectory(truth);
  try {
    return has_instants ? associateByTime(estimated, true_poses) : associateByRows(estimated, true_poses);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(estimate.string() + " and " + truth.string() + ": " + error.what());
  }
}

}  // namespace cartvo
