// How the truth's axes are turned against the estimate's.
#include "tools/evaluate/axes_alignment.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <vector>

#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/segments.hpp"

namespace cartvo {
namespace {

constexpr int kIterations = 5;  // of Gauss-Newton; angles are small
// Of a segment's length, squared; an estimate that stands tells nothing.
constexpr double kLeastMotion = 1e-9;
// Of the greatest eigenvalue: the squared sine of six degrees.
constexpr double kLeastBend = 0.01;

struct Displacements {
  Eigen::Vector3d estimate, truth;  // of a segment, in the axes at its start, as parts of its length
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

Eigen::Matrix3d crossProductMatrix(const Eigen::Vector3d& vector) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -vector.z(), vector.y(), vector.z(), 0.0, -vector.x(), -vector.y(), vector.x(), 0.0;
  return matrix;
}

Eigen::Matrix3d rotationFromVector(const Eigen::Vector3d& rotation) {
  return Eigen::AngleAxisd(rotation.norm(), rotation.stableNormalized()).toRotationMatrix();
}

/// The least of the solutions of matrix x = right_side, without the directions that hardly count.
Eigen::Vector3d solveWhereTold(const Eigen::Matrix3d& matrix, const Eigen::Vector3d& right_side) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  const Eigen::Vector3d& values = solver.eigenvalues();
  Eigen::Vector3d solution = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (values[i] <= kLeastMotion || values[i] < kLeastBend * values[2]) continue;
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
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const Displacements& of : displacements) {
      // exp(w) R t = R t - [R t]x w, to first order.
      const Eigen::Vector3d turned = R * of.estimate;
      const Eigen::Matrix3d by_rotation = -crossProductMatrix(turned);
      hessian += by_rotation.transpose() * by_rotation;
      gradient += by_rotation.transpose() * (of.truth - turned);
    }
    R = rotationFromVector(solveWhereTold(hessian / count, gradient / count)) * R;
  }
  const Eigen::AngleAxisd rotation(R);
  return rotation.angle() * rotation.axis();
}

Trajectory inTurnedAxes(const Trajectory& estimate, const Eigen::Vector3d& rotation) {
  const Eigen::Isometry3d turn(rotationFromVector(rotation));
  Trajectory turned = estimate;
  for (StampedPose& stamped : turned)
    stamped.pose = turn * estimate.front().pose.inverse() * stamped.pose * turn.inverse();
  return turned;
}

}  // namespace cartvo
