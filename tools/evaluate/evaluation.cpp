// Computes the error measures of a trajectory.

#include "tools/evaluate/evaluation.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "tools/evaluate/alignment.hpp"
#include "tools/evaluate/axes_alignment.hpp"
#include "tools/evaluate/plausibility/conventions.hpp"
#include "tools/evaluate/segments.hpp"

namespace cartvo {
namespace {

/// Rotation angle, rad. Exact for small angles, where arccos of the trace is not.
double angle(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

/// Transform from the estimated to the true motion between two poses.
Eigen::Isometry3d motionError(const AssociatedTrajectories& associated, std::size_t from, std::size_t to) {
  const auto motion = [&](const Trajectory& trajectory) {
    return trajectory[from].pose.inverse() * trajectory[to].pose;
  };
  return motion(associated.estimate).inverse() * motion(associated.truth);
}

/// Mean of segment errors, weighted by their counts.
class SegmentMean {
 public:
  void add(const SegmentErrors& errors) {
    count_ += errors.count;
    translation_ += errors.translation * errors.count;
    rotation_ += errors.rotation * errors.count;
  }
  SegmentErrors mean(double length) const {
    if (count_ == 0) return {length, 0, 0.0, 0.0};
    return {length, count_, translation_ / count_, rotation_ / count_};
  }

 private:
  int count_ = 0;
  double translation_ = 0.0, rotation_ = 0.0;
};

SegmentGroup segmentErrors(const AssociatedTrajectories& associated, std::span<const double> lengths,
                           std::size_t step) {
  const std::vector<double> distances = distancesAlong(associated.truth);
  SegmentGroup group;
  SegmentMean all;
  for (const double length : lengths) {
    SegmentMean mean;
    forEachSegment(distances, length, step, [&](std::size_t first, std::size_t last) {
      const Eigen::Isometry3d error = motionError(associated, first, last);
      mean.add({length, 1, error.translation().norm() / length, angle(error.linear()) / length});
    });
    const SegmentErrors errors = mean.mean(length);
    if (errors.count > 0) group.each.push_back(errors);
    all.add(errors);
  }
  group.all = all.mean(0.0);
  return group;
}

double originError(const AssociatedTrajectories& associated) {
  const Trajectory moved = placedEstimate(associated);
  double squares = 0.0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    squares += (moved[i].pose.translation() - associated.truth[i].pose.translation()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(moved.size()));
}

void measureRelative(const AssociatedTrajectories& associated, Evaluation& evaluation) {
  double translation = 0.0, rotation = 0.0;
  const std::size_t motions = associated.estimate.size() - 1;
  for (std::size_t i = 0; i < motions; ++i) {
    const Eigen::Isometry3d error = motionError(associated, i, i + 1);
    translation += error.translation().squaredNorm();
    rotation += angle(error.linear()) * angle(error.linear());
  }
  evaluation.relative_translation = std::sqrt(translation / static_cast<double>(motions));
  evaluation.relative_rotation = std::sqrt(rotation / static_cast<double>(motions));
}

}  // namespace

std::optional<AlignedAxes> alignedAxes(const AssociatedTrajectories& associated) {
  const auto rotation = axesRotation(associated);
  if (!rotation) return std::nullopt;
  AssociatedTrajectories turned = associated;
  turned.estimate = rotateAxes(associated.estimate, *rotation);
  return AlignedAxes{*rotation, segmentErrors(turned, kShortSegments, 1)};
}

std::vector<double> distancesAlong(const Trajectory& trajectory) {
  std::vector<double> distances;
  distances.reserve(trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const double step =
        i == 0 ? 0.0 : (trajectory[i].pose.translation() - trajectory[i - 1].pose.translation()).norm();
    distances.push_back(i == 0 ? 0.0 : distances.back() + step);
  }
  return distances;
}

Trajectory startingAt(const Eigen::Isometry3d& start, const Trajectory& trajectory) {
  const Eigen::Isometry3d move = start * trajectory.front().pose.inverse();
  Trajectory moved = trajectory;
  for (StampedPose& stamped : moved)
    stamped.pose = move * stamped.pose;
  return moved;
}

Evaluation evaluate(const AssociatedTrajectories& associated) {
  Evaluation evaluation;
  evaluation.method = associated.method;
  evaluation.poses = associated.estimate.size();
  evaluation.unmatched = associated.unmatched;
  evaluation.path_length = distancesAlong(associated.truth).back();
  evaluation.estimated_path_length = distancesAlong(associated.estimate).back();

  const Eigen::Isometry3d end = motionError(associated, 0, evaluation.poses - 1);
  evaluation.final_drift = end.translation().norm();
  evaluation.final_rotation = angle(end.linear());
  constexpr double kMinPathLength = 1.0;  // m; at a standstill a percentage is meaningless
  if (evaluation.path_length >= kMinPathLength) {
    evaluation.final_drift_fraction = evaluation.final_drift / evaluation.path_length;
  }
  evaluation.absolute_aligned = alignedError(associated);
  evaluation.absolute_origin = originError(associated);
  measureRelative(associated, evaluation);
  evaluation.short_segments = segmentErrors(associated, kShortSegments, 1);
  evaluation.long_segments = segmentErrors(associated, kLongSegments, 10);
  evaluation.aligned_axes = alignedAxes(associated);
  if (associated.scale != 1.0) evaluation.scale = associated.scale;
  evaluation.problems = associated.problems;
  if (associated.clocks_differ) return evaluation;  // poses of other instants tell nothing about conventions
  if (std::string problem = conventionProblem(associated, evaluation); !problem.empty())
    evaluation.problems.push_back(std::move(problem));
  return evaluation;
}

}  // namespace cartvo
