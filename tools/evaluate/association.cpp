// Associates the poses of an estimate with the truth.

#include "tools/evaluate/association.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/statistics.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/evaluate/plausibility/clock_agreement.hpp"

namespace cartvo {
namespace {

/// Widest gap in a truth over which to interpolate: three of its median periods, but at least the first and
/// at most the second of these. Milliseconds that were read as seconds leave longer ones.
constexpr std::int64_t kMaxGap_ns = 250'000'000, kMaxGapOfSlowTruth_ns = 6'000'000'000;

/// A pose of the estimate this little before the truth's first or after its last pose is associated with that
/// pose: times in a camera's 90 kHz clock are rounded by some us.
constexpr std::int64_t kEndTolerance_ns = 1'000'000;

/// Median time between the poses, ns; 0 for a single one.
std::int64_t medianPeriod(const Trajectory& truth) {
  std::vector<std::int64_t> periods;
  for (std::size_t i = 1; i < truth.size(); ++i)
    periods.push_back(truth[i].time_ns - truth[i - 1].time_ns);
  return periods.empty() ? 0 : median(periods);
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

std::string span(const Trajectory& trajectory) {
  char text[80];
  std::snprintf(text, sizeof text, "%.3f s to %.3f s", seconds(trajectory.front().time_ns),
                seconds(trajectory.back().time_ns));
  return text;
}

}  // namespace

InterpolatedTruth::InterpolatedTruth(const Trajectory& truth)
    : truth_(truth),
      period_ns_(medianPeriod(truth)),
      max_gap_ns_(std::clamp(3 * period_ns_, kMaxGap_ns, kMaxGapOfSlowTruth_ns)) {}

std::optional<StampedPose> InterpolatedTruth::at(std::int64_t time_ns) const {
  const std::int64_t inside_ns = std::clamp(time_ns, truth_.front().time_ns, truth_.back().time_ns);
  if (std::abs(time_ns - inside_ns) > kEndTolerance_ns) return std::nullopt;
  const auto after = std::lower_bound(
      truth_.begin(), truth_.end(), inside_ns,
      [](const StampedPose& true_pose, std::int64_t instant_ns) { return true_pose.time_ns < instant_ns; });
  if (after->time_ns == inside_ns) return *after;
  if (after->time_ns - std::prev(after)->time_ns > max_gap_ns_) return std::nullopt;
  return interpolate(*std::prev(after), *after, inside_ns);
}

AssociatedTrajectories associateByTime(const Trajectory& estimate, const Trajectory& truth) {
  AssociatedTrajectories associated;
  associated.method = AssociationMethod::time;
  const InterpolatedTruth interpolated(truth);
  for (const StampedPose& stamped : estimate) {
    const std::optional<StampedPose> true_pose = interpolated.at(stamped.time_ns);
    if (!true_pose) {
      ++associated.unmatched;
      continue;
    }
    associated.estimate.push_back(stamped);
    associated.truth.push_back(*true_pose);
  }
  const std::string problem = clockProblem(estimate, truth);
  if (associated.estimate.size() < 2) {
    throw std::runtime_error(
        "fewer than two poses of the estimate have a truth at their time: the estimate is of " +
        span(estimate) + ", the truth of " + span(truth) +
        "; check that both are of one drive ('cartvo simulate' keeps the truth of an earlier run as "
        "truth-SECOND.tum) and one clock, in seconds; --offset of 'cartvo evaluate' adds to the estimate's "
        "instants" +
        (problem.empty() ? "" : ". " + problem));
  }
  associated.clocks_differ = !problem.empty();
  if (associated.clocks_differ) associated.problems.push_back(problem);
  return associated;
}

AssociatedTrajectories associateByRows(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.size() != truth.size()) {
    throw std::runtime_error("the estimate has " + std::to_string(estimate.size()) + " poses, the truth " +
                             std::to_string(truth.size()) +
                             "; KITTI rows have no times, so both files must contain the same frames. Give "
                             "files with times instead, as replay's trajectory.tum and a truth.tum");
  }
  if (estimate.size() < 2)
    throw std::runtime_error("a trajectory of one pose cannot be evaluated; at least two are needed");
  AssociatedTrajectories associated;
  associated.estimate = estimate;
  associated.truth = truth;
  return associated;
}

std::string frameProblem(const std::filesystem::path& estimate, TrajectoryFrame estimated,
                         const std::filesystem::path& truth, bool aligns) {
  const TrajectoryFrame true_frame = frameOf(truth);
  const bool both_known = estimated != TrajectoryFrame::unknown && true_frame != TrajectoryFrame::unknown;
  if (aligns || !both_known || estimated == true_frame) return {};
  const std::string frames = estimate.string() + " has poses of " + frameName(estimated) + ", " +
                             truth.string() + " of " + frameName(true_frame);
  if (estimated != TrajectoryFrame::left_camera && true_frame != TrajectoryFrame::left_camera)
    return frames +
           ": state T_body_camera in the rig ('cartvo calibrate mount') and replay again, or compare with "
           "--align";
  throw std::runtime_error(
      frames +
      ", as their first lines state (KITTI's rows are of the left camera); compare files of the "
      "same frame: of a replay, poses.txt is of the left camera and trajectory.tum of the cart's "
      "body; or compare with --align");
}

AssociatedTrajectories associateFiles(const std::filesystem::path& estimate,
                                      const std::filesystem::path& truth,
                                      const ComparisonSettings& settings) {
  Trajectory estimated = readTrajectory(estimate);
  const Trajectory true_poses = readTrajectory(truth);
  const std::string problem = frameProblem(estimate, frameOf(estimate), truth, settings.aligns);
  const bool has_instants = !isKittiTrajectory(estimate) && !isKittiTrajectory(truth);
  try {
    if (!has_instants && settings.offset_ns != 0)
      throw std::runtime_error("rows of KITTI have no instants to which --offset could add");
    for (StampedPose& stamped : estimated)
      stamped.time_ns += settings.offset_ns;
    AssociatedTrajectories associated =
        has_instants ? associateByTime(estimated, true_poses) : associateByRows(estimated, true_poses);
    if (!problem.empty()) associated.problems.push_back(problem);
    fitEstimate(settings, associated);
    return associated;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(estimate.string() + " and " + truth.string() + ": " + error.what());
  }
}

}  // namespace cartvo
