// Estimates the rotation between the estimate's and the truth's axes.
#include "tools/evaluate/axes_alignment.hpp"

#include <Eigen/Eigenvalues>
#include <vector>

#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/segments.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {
namespace {

constexpr int kIterations = 5;  // of Gauss-Newton; angles are small
// Relative to the squared segment length; smaller eigenvalues belong to a standstill.
constexpr double kMinEigenvalue = 1e-9;
// Relative to the largest eigenvalue: the squared sine of six degrees.
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

/// Minimum-norm solution of matrix x = right_side, without the unobservable directions.
Eigen::Vector3d solveObservable(const Eigen::Matrix3d& matrix, const Eigen::Vector3d& right_side) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  const Eigen::Vector3d& values = solver.eigenvalues();
  Eigen::Vector3d solution = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (values[i] <= kMinEigenvalue || values[i] < kMinEigenvalueRatio * values[2]) continue;
    const Eigen::Vector3d direction = solver.eigenvectors().col(i);
    solution += direction.dot(right_side) / values[i] * direction;
  }
  return solution;
}

}  // namespace

std::optional<Eigen::Vector3d> axesRotation(const AssociatedTrajectories& associated) {
  const std::vector<Displacements> displacements = shortDisplacements(associated);
  if (displacements.empty()) return std::nullopt;
  const auto count = static_cast<double>(displacements.size());
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const Displacements& displacement : displacements) {
      // Rotated by a further w, t becomes t - skew(t) w to first order.
      const Eigen::Vector3d turned = turn * displacement.estimate;
      const Eigen::Matrix3d by_rotation = -vo::skew(turned);
      hessian += by_rotation.transpose() * by_rotation;
      gradient += by_rotation.transpose() * (displacement.truth - turned);
    }
    turn = rotationTransform(solveObservable(hessian / count, gradient / count)) * turn;
  }
  return vo::vectorFromMotion(turn).tail<3>();
}

Trajectory rotateAxes(const Trajectory& estimate, const Eigen::Vector3d& rotation) {
  const Eigen::Isometry3d turn = rotationTransform(rotation);
  Trajectory turned = estimate;
  for (StampedPose& stamped : turned)
    stamped.pose = turn * estimate.front().pose.inverse() * stamped.pose * turn.inverse();
  return turned;
}

}  // namespace cartvo
