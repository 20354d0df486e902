// Estimates the rotation between the estimate's and the truth's axes.
#include "tools/evaluate/axes_alignment.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <vector>

#include "calib/model/rotation.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/segments.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {
namespace {

// Relative to the squared segment length; smaller eigenvalues belong to a standstill.
constexpr double kMinEigenvalue = 1e-9;
// Relative to the sum of the eigenvalues: the squared sine of six degrees.
constexpr double kMinEigenvalueRatio = 0.01;

struct Displacements {
  Eigen::Vector3d estimate, truth;  // of a segment, in the axes at its start, divided by its length
};

std::vector<Displacements> shortDisplacements(const AssociatedTrajectories& associated) {
  const auto displacement = [](const Trajectory& trajectory, std::size_t first, std::size_t last) {
    return Eigen::Vector3d(trajectory[first].pose.inverse() * trajectory[last].pose.translation());
  };
  std::vector<Displacements> displacements;
  const std::vector<double> distances = distancesAlong(associated.truth);
  for (const double length : kShortSegments)
    forEachSegment(distances, length, 1, [&](std::size_t first, std::size_t last) {
      displacements.push_back({displacement(associated.estimate, first, last) / length,
                               displacement(associated.truth, first, last) / length});
    });
  return displacements;
}

Eigen::Isometry3d rotationTransform(const Eigen::Vector3d& rotation) {
  vo::Vector6d motion;
  motion << Eigen::Vector3d::Zero(), rotation;
  return vo::motionFromVector(motion);
}

}  // namespace

std::optional<Eigen::Vector3d> axesRotation(const AssociatedTrajectories& associated) {
  const std::vector<Displacements> displacements = shortDisplacements(associated);
  if (displacements.empty()) return std::nullopt;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero(), squares = Eigen::Matrix3d::Zero();
  for (const Displacements& displacement : displacements) {
    products += displacement.truth * displacement.estimate.transpose();
    squares += displacement.estimate * displacement.estimate.transpose();
  }
  const Eigen::Vector3d spread =  // in increasing order
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squares / static_cast<double>(displacements.size()))
          .eigenvalues();
  if (spread[2] <= kMinEigenvalue) return Eigen::Vector3d::Zero();
  // Of a straight path, also one forth and back, only its direction is known.
  Eigen::Matrix3d turn = calib::bestRotation(products);
  if (spread[0] + spread[1] < kMinEigenvalueRatio * spread.sum()) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
    turn = Eigen::Quaterniond::FromTwoVectors(svd.matrixV().col(0), svd.matrixU().col(0)).toRotationMatrix();
  }
  const Eigen::AngleAxisd rotation(turn);
  return Eigen::Vector3d(rotation.angle() * rotation.axis());
}

Trajectory rotateAxes(const Trajectory& estimate, const Eigen::Vector3d& rotation) {
  const Eigen::Isometry3d turn = rotationTransform(rotation);
  Trajectory turned = estimate;
  for (StampedPose& stamped : turned)
    stamped.pose = turn * estimate.front().pose.inverse() * stamped.pose * turn.inverse();
  return turned;
}

}  // namespace cartvo
