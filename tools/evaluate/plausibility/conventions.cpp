// Tests other readings of poses: orders of quaternions, directions of poses, axes.
#include "tools/evaluate/plausibility/conventions.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "common/units.hpp"

namespace cartvo {
namespace {

using Pose = Eigen::Isometry3d;

Pose withRotation(const Pose& pose, const Eigen::Matrix3d& rotation) {
  Pose changed = pose;
  changed.linear() = rotation;
  return changed;
}

/// Another reading of a pose.
struct Reading {
  Pose (*pose)(const Pose& pose);
  const char* text;
};

/// Inverse poses of one file agree with the other's as well as the reverse: both stand for "one of the
/// files".
constexpr std::array<Reading, 3> kReadings{
    {{[](const Pose& pose) {
        const Eigen::Quaterniond q(pose.linear());
        return withRotation(pose, Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix());
      },
      "its quaternions seem to be written with w first, or the other's with w last: name the columns in a "
      "comment "
      "in front of the rows, such as '# t x y z qw qx qy qz'"},
     {[](const Pose& pose) { return Pose(pose.inverse()); },
      "the poses of one of the two files seem to be inverse (from the world to the camera or body): invert "
      "them"},
     {[](const Pose& pose) { return withRotation(pose, pose.linear().transpose()); },
      "the rotations of one of the two files seem to be inverse (from the world to the camera or body): "
      "invert "
      "them"}}};

/// Disagreement of short segments once the axes are aligned: translation and, at the distance of a segment's
/// length, rotation. Of readings that differ by turned axes, those with less of a turn agree better. Empty
/// without a segment.
std::optional<double> disagreement(const std::optional<AlignedAxes>& aligned) {
  constexpr double kDistance = 5.0, kPerTurn = 1e-3;  // m, 1/rad
  if (!aligned) return std::nullopt;
  const SegmentErrors& errors = aligned->short_segments.all;
  return errors.translation + kDistance * errors.rotation + kPerTurn * aligned->rotation.norm();
}

AssociatedTrajectories reread(AssociatedTrajectories associated, bool is_estimate, const Reading& reading) {
  for (StampedPose& stamped : is_estimate ? associated.estimate : associated.truth)
    stamped.pose = reading.pose(stamped.pose);
  return associated;
}

/// The rotation of the axes if it is larger than an error of a mounting and explains the disagreement.
std::string axesProblem(const Evaluation& evaluation) {
  constexpr double kMaxMountingError_deg = 2.0, kMaxRemainder = 0.7, kOtherFrame_deg = 45.0;
  const Eigen::Vector3d rotation = kDegreesPerRadian * evaluation.aligned_axes->rotation;
  const double turned_deg = rotation.norm();
  const double remainder = evaluation.aligned_axes->short_segments.all.translation;
  if (turned_deg <= kMaxMountingError_deg ||
      remainder > kMaxRemainder * evaluation.short_segments.all.translation)
    return {};
  const Eigen::Vector3d axis = rotation / turned_deg;
  const bool is_other_frame = turned_deg > kOtherFrame_deg;
  return fmt::format(
      "the axes of the two files differ by {:.1f} deg: the estimate's are turned about ({:.2f}, {:.2f}, "
      "{:.2f}); {}; or "
      "compare with --align",
      turned_deg, axis.x(), axis.y(), axis.z(),
      is_other_frame
          ? "is one of the left camera (poses.txt of a replay, KITTI) and the other of the cart's body "
            "(trajectory.tum), or in axes forward, right, down (NED)? Compare files of the same frame"
          : "the mount of a sensor is unknown or wrong: state T_body_camera in the rig ('cartvo calibrate "
            "mount')");
}

}  // namespace

std::string conventionProblem(const AssociatedTrajectories& associated, const Evaluation& evaluation) {
  const std::optional<double> present = disagreement(evaluation.aligned_axes);
  constexpr double kNegligible = 0.003, kMaxRatio = 1.0 / 3.0;
  if (!present) return {};
  if (*present < kNegligible) return axesProblem(evaluation);
  double best = kMaxRatio * *present;
  std::string problem;
  for (const Reading& reading : kReadings) {
    for (const bool is_estimate : {true, false}) {
      const std::optional<double> other = disagreement(alignedAxes(reread(associated, is_estimate, reading)));
      constexpr double kEqual = 1e-6;
      if (!other || *other >= best - kEqual) continue;
      best = *other;
      problem = std::string(is_estimate ? "the estimate" : "the truth") +
                " is read in another convention: " + reading.text;
    }
  }
  return problem.empty() ? axesProblem(evaluation) : problem;
}

}  // namespace cartvo
