// B-splines of a camera's motion.
#include "vo_core/window/trajectory.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {
namespace {

/// Right Jacobian of SO(3) at a rotation vector (T. Barfoot, "State Estimation for Robotics", 2017, eq. 7.77,
/// 7.78).
Eigen::Matrix3d rightJacobianOfRotation(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d W = skew(rotation);
  if (angle < 1e-5) return Eigen::Matrix3d::Identity() - 0.5 * W + W * W / 6.0;
  const double squared = angle * angle;
  return Eigen::Matrix3d::Identity() - (1.0 - std::cos(angle)) / squared * W +
         (angle - std::sin(angle)) / (squared * angle) * W * W;
}

using Matrices = std::array<Eigen::Matrix3d, Trajectory::kSupport>;

Eigen::Matrix3d rotationOf(const Eigen::Vector3d& vector) {
  Vector6d motion = Vector6d::Zero();
  motion.tail<3>() = vector;
  return motionFromVector(motion).linear();
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
    : start_(start), interval_(interval), knots_(kSupport, pose), turns_(kSupport - 1) {
  for (int i = 0; i < kSupport - 1; ++i)
    updateTurn(i);
}

void Trajectory::updateTurn(int i) {
  if (i < 0 || i + 1 >= size()) return;
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.linear() = knot(i).linear().transpose() * knot(i + 1).linear();
  const Eigen::Vector3d vector = vectorFromMotion(turn).tail<3>();
  turns_[static_cast<std::size_t>(i)] = {vector, rightJacobianOfRotation(vector).inverse()};
}

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
  std::array<double, kSupport> sums{}, rates{}, seconds{};
  Matrices later;  // transposed product of the rotations after the j-th
  later[3].setIdentity();
  for (int j = 3; j > 0; --j) {
    sums[j] = basis.value[j] + (j < 3 ? sums[j + 1] : 0.0);
    rates[j] = basis.derivative[j] + (j < 3 ? rates[j + 1] : 0.0);
    seconds[j] = basis.second[j] + (j < 3 ? seconds[j + 1] : 0.0);
    later[j - 1] = later[j] * rotationOf(sums[j] * turnFrom(at.first + j - 1).vector).transpose();
  }
  at.rotation = knot(at.first).linear() * later[0].transpose();
  at.rate.setZero();
  at.angular_acceleration.setZero();
  at.turn_by_knot.fill(Eigen::Matrix3d::Zero());
  at.turn_by_knot[0] = later[0];
  for (int j = 1; j < kSupport; ++j) {
    const Turn& turn = turnFrom(at.first + j - 1);
    const Eigen::Vector3d axis = later[j] * turn.vector;
    at.rate += rates[j] * axis;
    at.angular_acceleration += seconds[j] * axis + rates[j] * at.rate.cross(axis);
    const Eigen::Matrix3d by_turn = sums[j] * later[j] * rightJacobianOfRotation(sums[j] * turn.vector);
    at.turn_by_knot[j] += by_turn * turn.by_next;
    at.turn_by_knot[j - 1] -= by_turn * turn.by_next.transpose();
  }
  return at;
}

void Trajectory::move(int i, const Vector6d& step) {
  Eigen::Isometry3d& moved = knots_[static_cast<std::size_t>(i)];
  const Eigen::Vector3d position = moved.translation() + step.head<3>();
  moved = orthonormalised(moved * Eigen::Isometry3d(rotationOf(step.tail<3>())));
  moved.translation() = position;
  updateTurn(i - 1);
  updateTurn(i);
}

void Trajectory::set(int i, const Eigen::Isometry3d& knot) {
  knots_[static_cast<std::size_t>(i)] = knot;
  updateTurn(i - 1);
  updateTurn(i);
}

void Trajectory::extendTo(double time) {
  while (end() < time) {
    const Eigen::Isometry3d &before = knots_[knots_.size() - 2], &last = knots_.back();
    Eigen::Isometry3d next = Eigen::Isometry3d::Identity();
    next.linear() = last.linear() * before.linear().transpose() * last.linear();
    next.translation() = 2.0 * last.translation() - before.translation();
    knots_.push_back(orthonormalised(next));
    turns_.emplace_back();
    updateTurn(size() - 2);
  }
}

void Trajectory::removeOldest(int count) {
  knots_.erase(knots_.begin(), knots_.begin() + count);
  turns_.erase(turns_.begin(), turns_.begin() + count);
  start_ += interval_ * count;
}

Vector6d Trajectory::thirdDifferences(int first) const {
  Vector6d differences;
  differences.setZero();
  for (int i = 0; i < kSupport; ++i)
    differences.head<3>() += kThirdDifference[i] * knot(first + i).translation();
  differences.tail<3>() =
      turnFrom(first).vector - 2.0 * turnFrom(first + 1).vector + turnFrom(first + 2).vector;
  return differences;
}

Matrices Trajectory::turnDifferencesByKnot(int first) const {
  Matrices by_knot;
  by_knot.fill(Eigen::Matrix3d::Zero());
  constexpr std::array<double, 3> kFactors{1.0, -2.0, 1.0};
  for (int j = 0; j < 3; ++j) {
    const Eigen::Matrix3d& by_next = turnFrom(first + j).by_next;
    by_knot[j + 1] += kFactors[j] * by_next;
    by_knot[j] -= kFactors[j] * by_next.transpose();
  }
  return by_knot;
}

}  // namespace cartvo::vo
