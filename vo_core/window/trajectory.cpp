// B-splines of a camera's motion.
#include "vo_core/window/trajectory.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "vo_core/geometry/reprojection.hpp"

namespace cartvo::vo {
namespace {

using Matrices = std::array<Eigen::Matrix3d, Trajectory::kSupport>;

Eigen::Matrix3d rotationOf(const Eigen::Vector3d& vector) {
  Vector6d motion = Vector6d::Zero();
  motion.tail<3>() = vector;
  return motionFromVector(motion).linear();
}

/// Rotation vector from one knot to the next.
Eigen::Vector3d turnBetween(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.linear() = from.linear().transpose() * to.linear();
  return vectorFromMotion(turn).tail<3>();
}

/// Derivative of turnBetween() by the second knot; by the first, that of the opposite turn, negative.
Eigen::Matrix3d turnByNext(const Eigen::Vector3d& turn) {
  return rightJacobianOfRotation(turn).inverse();
}

struct Basis {
  std::array<double, Trajectory::kSupport> value, derivative, second;  ///< derivatives in 1/s and 1/s^2
};

Basis basisAt(double u, double interval) {
  const double v = 1.0 - u, s = u * u, square = interval * interval;
  return {{v * v * v / 6.0, (3.0 * s * u - 6.0 * s + 4.0) / 6.0,
           (-3.0 * s * u + 3.0 * s + 3.0 * u + 1.0) / 6.0, s * u / 6.0},
          {-v * v / 2.0 / interval, (9.0 * s - 12.0 * u) / 6.0 / interval,
           (-9.0 * s + 6.0 * u + 3.0) / 6.0 / interval, s / 2.0 / interval},
          {v / square, (3.0 * u - 2.0) / square, (1.0 - 3.0 * u) / square, u / square}};
}

}  // namespace

Eigen::Isometry3d Trajectory::Instant::pose() const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation;
  pose.translation() = position;
  return pose;
}

Trajectory::Trajectory(double start, double interval, const Eigen::Isometry3d& pose)
    : start_(start), interval_(interval), knots_(kSupport, pose) {}

Trajectory::Instant Trajectory::at(double time) const {
  const double place = (time - start_) / interval_;
  Instant at;
  at.first = std::clamp(static_cast<int>(std::floor(place)), 0, size() - kSupport);
  const Basis basis = basisAt(place - at.first, interval_);
  at.by_knot = basis.value;
  at.velocity_by_knot = basis.derivative;
  at.position.setZero();
  at.velocity.setZero();
  at.acceleration.setZero();
  for (int i = 0; i < kSupport; ++i) {
    at.position += basis.value[i] * knot(at.first + i).translation();
    at.velocity += basis.derivative[i] * knot(at.first + i).translation();
    at.acceleration += basis.second[i] * knot(at.first + i).translation();
  }
  // R = R_0 exp(l_1 d_1) exp(l_2 d_2) exp(l_3 d_3), d_j from knot to knot, l_j sums of the basis.
  std::array<Eigen::Vector3d, kSupport> turns;
  std::array<double, kSupport> sums{}, rates{}, seconds{};
  Matrices later;  // transposed product of the rotations after the j-th
  later[3].setIdentity();
  for (int j = 3; j > 0; --j) {
    sums[j] = basis.value[j] + (j < 3 ? sums[j + 1] : 0.0);
    rates[j] = basis.derivative[j] + (j < 3 ? rates[j + 1] : 0.0);
    seconds[j] = basis.second[j] + (j < 3 ? seconds[j + 1] : 0.0);
    turns[j] = turnBetween(knot(at.first + j - 1), knot(at.first + j));
    later[j - 1] = later[j] * rotationOf(sums[j] * turns[j]).transpose();
  }
  at.rotation = knot(at.first).linear() * later[0].transpose();
  at.rate.setZero();
  at.angular_acceleration.setZero();
  at.turn_by_knot.fill(Eigen::Matrix3d::Zero());
  at.turn_by_knot[0] = later[0];
  for (int j = 1; j < kSupport; ++j) {
    const Eigen::Vector3d axis = later[j] * turns[j];
    at.rate += rates[j] * axis;
    at.angular_acceleration += seconds[j] * axis + rates[j] * at.rate.cross(axis);
    const Eigen::Matrix3d by_turn = sums[j] * later[j] * rightJacobianOfRotation(sums[j] * turns[j]);
    at.turn_by_knot[j] += by_turn * turnByNext(turns[j]);
    at.turn_by_knot[j - 1] -= by_turn * turnByNext(-turns[j]);
  }
  return at;
}

void Trajectory::move(int i, const Vector6d& step) {
  Eigen::Isometry3d& moved = knots_[static_cast<std::size_t>(i)];
  const Eigen::Vector3d position = moved.translation() + step.head<3>();
  moved = orthonormalised(moved * Eigen::Isometry3d(rotationOf(step.tail<3>())));
  moved.translation() = position;
}

void Trajectory::extendTo(double time) {
  while (end() < time) {
    const Eigen::Isometry3d &before = knots_[knots_.size() - 2], &last = knots_.back();
    Eigen::Isometry3d next = Eigen::Isometry3d::Identity();
    next.linear() = last.linear() * before.linear().transpose() * last.linear();
    next.translation() = 2.0 * last.translation() - before.translation();
    knots_.push_back(orthonormalised(next));
  }
}

void Trajectory::removeOldest(int count) {
  knots_.erase(knots_.begin(), knots_.begin() + count);
  start_ += interval_ * count;
}

Vector6d Trajectory::thirdDifferences(int first) const {
  Vector6d differences;
  differences.setZero();
  for (int i = 0; i < kSupport; ++i)
    differences.head<3>() += kThirdDifference[i] * knot(first + i).translation();
  differences.tail<3>() = turnBetween(knot(first), knot(first + 1)) -
                          2.0 * turnBetween(knot(first + 1), knot(first + 2)) +
                          turnBetween(knot(first + 2), knot(first + 3));
  return differences;
}

Matrices Trajectory::turnDifferencesByKnot(int first) const {
  Matrices by_knot;
  by_knot.fill(Eigen::Matrix3d::Zero());
  constexpr std::array<double, 3> kFactors{1.0, -2.0, 1.0};
  for (int j = 0; j < 3; ++j) {
    const Eigen::Vector3d turn = turnBetween(knot(first + j), knot(first + j + 1));
    by_knot[j + 1] += kFactors[j] * turnByNext(turn);
    by_knot[j] -= kFactors[j] * turnByNext(-turn);
  }
  return by_knot;
}

}  // namespace cartvo::vo
