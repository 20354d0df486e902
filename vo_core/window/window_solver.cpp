// Gauss-Newton on a window.
#include "vo_core/window/window_solver.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

constexpr double kStep = 2e-4;  // s, of derivatives by time

/// Derivatives of the position in the world's axes and of the rotation (on the right) by the unknowns.
Rows byUnknowns(const Trajectory::Instant& instant, Eigen::Index unknowns) {
  Rows rows = Rows::Zero(6, unknowns);
  for (int i = 0; i < Trajectory::kSupport; ++i) {
    const Eigen::Index at = columnOf(instant.first + i);
    rows.block<3, 3>(0, at).diagonal().setConstant(instant.by_knot[i]);
    rows.block<3, 3>(3, at + 3) = instant.turn_by_knot[i];
  }
  return rows;
}

/// Derivatives of the angular rate, in the camera's axes, by the unknowns.
Eigen::Matrix<double, 3, Eigen::Dynamic> rateByUnknowns(const Trajectory& trajectory, double time,
                                                        Eigen::Index unknowns) {
  const Trajectory::Instant before = trajectory.at(time - kStep), after = trajectory.at(time + kStep);
  return (byUnknowns(after, unknowns).bottomRows<3>() -
          after.rotation.transpose() * before.rotation * byUnknowns(before, unknowns).bottomRows<3>()) /
         (2.0 * kStep);
}

/// Covariance of what depends on the unknowns by `rows`, on none but those of the knots from the first one of
/// an instant to the last one of another.
Matrix6d carried(const Rows& rows, const WindowResult& result, const Trajectory::Instant& from,
                 const Trajectory::Instant& to) {
  const Eigen::Index at = columnOf(from.first), size = columnOf(to.first + Trajectory::kSupport) - at;
  const auto used = rows.middleCols(at, size);
  return used * result.covariance.block(at, at, size, size) * used.transpose();
}

WindowJerkSums jerkOf(const WindowProblem& problem, const Eigen::MatrixXd& covariance) {
  constexpr int kNewest = 6;  // third differences
  const Trajectory& trajectory = problem.trajectory;
  const double cube = std::pow(trajectory.interval(), 3);
  const Eigen::Vector2d scales = Eigen::Vector2d(problem.jerk.translation, problem.jerk.rotation) * cube;
  WindowJerkSums sums;
  // Knots after the newest pair follow from the prior.
  int last = trajectory.size() - Trajectory::kSupport;
  while (last > 0 && trajectory.timeOf(last + Trajectory::kSupport - 1) > problem.pairs.back().time)
    --last;
  const int from = std::max(0, last - kNewest + 1);
  for (int first = from; first <= last; ++first) {
    const Vector6d differences = trajectory.thirdDifferences(first);
    const auto by_knot = trajectory.turnDifferencesByKnot(first);
    Eigen::Matrix<double, 6, 6 * Trajectory::kSupport> rows =
        Eigen::Matrix<double, 6, 6 * Trajectory::kSupport>::Zero();
    for (int i = 0; i < Trajectory::kSupport; ++i) {
      rows.block<3, 3>(0, 6 * i).diagonal().setConstant(Trajectory::kThirdDifference[i]);
      rows.block<3, 3>(3, 6 * i + 3) = by_knot[i];
    }
    const Matrix6d uncertain = rows *
                               covariance.block<6 * Trajectory::kSupport, 6 * Trajectory::kSupport>(
                                   columnOf(first), columnOf(first)) *
                               rows.transpose();
    for (int part = 0; part < 2; ++part) {
      const double variance = scales[part] * scales[part];
      const double square = differences.segment<3>(3 * part).squaredNorm() / variance;
      const double weight = jerkWeight(square);
      sums.squares[part] += weight * square;
      const double unknown = uncertain.diagonal().segment<3>(3 * part).sum() / variance;
      sums.freedom[part] += std::max(0.0, 3.0 - weight * unknown);
    }
  }
  return sums;
}

}  // namespace

bool WindowSolver::step(WindowProblem& problem, std::span<const double> scales, WindowNoiseSums* noise_sums) {
  problem.prior.extendTo(problem.trajectory);
  for (std::size_t iteration = 0; iteration < scales.size(); ++iteration) {
    equations_.setLandmarks(problem, problem.landmarks, iteration > 0 && scales[iteration] <= 1.0,
                            scales[iteration], iteration + 1 == scales.size() ? noise_sums : nullptr);
    equations_.addJerk(problem, problem.trajectory.size());
    equations_.discountTimes(problem.prior);
    equations_.addPrior(problem);
    factor_.compute(equations_.information());
    if (factor_.info() != Eigen::Success) return false;
    const Eigen::VectorXd step = factor_.solve(equations_.gradient());
    if (!step.allFinite()) return false;
    equations_.moveLandmarks(step, problem.landmarks);
    problem.shared += step.head<kSharedStates>();
    for (int i = 0; i < problem.trajectory.size(); ++i)
      problem.trajectory.move(i, step.segment<6>(columnOf(i)));
  }
  return true;
}

bool WindowSolver::explains(const WindowProblem& problem) const {
  std::size_t explained = 0;
  for (std::size_t i = 0; i < problem.landmarks.size(); ++i)
    if (fit(i).information > 0.0) ++explained;
  return 2 * explained >= problem.landmarks.size();
}

WindowResult WindowSolver::solve(WindowProblem& problem, std::span<const double> scales) {
  WindowResult result;
  result.noise = problem.noise;
  WindowNoiseSums noise_sums;
  if (!step(problem, scales, &noise_sums)) return result;
  result.covariance = equations_.covarianceBy(factor_.matrixLLT());
  result.noise = noise_sums.concluded(problem.noise);
  result.jerk = jerkOf(problem, result.covariance);
  result.converged = result.covariance.allFinite();
  return result;
}

void WindowSolver::marginalise(WindowProblem& problem, const std::vector<WindowLandmark>& ended, int knots) {
  if (ended.empty() && knots == 0) return;
  problem.prior.extendTo(problem.trajectory);
  equations_.setLandmarks(problem, ended, true, 1.0);
  equations_.addJerk(problem, knots);
  WindowPrior& prior = problem.prior;
  equations_.discountTimes(prior);
  prior.vector +=
      equations_.gradient() + equations_.information() * prior.changeTo(problem.shared, problem.trajectory);
  prior.information += equations_.information();
  prior.marginaliseOldest(knots);
  problem.trajectory.removeOldest(knots);
}

void tieToStart(double time, const Eigen::Isometry3d& pose, const Matrix6d& covariance,
                const Vector6d& velocity_stddev, WindowProblem& problem) {
  constexpr double kAcceleration = 30.0;  // stddev; m/s^2 and rad/s^2
  const Trajectory& trajectory = problem.trajectory;
  WindowPrior& prior = problem.prior;
  prior.extendTo(trajectory);
  const Trajectory::Instant instant = trajectory.at(time);
  const Rows rows = byUnknowns(instant, prior.information.rows());
  const Matrix6d information = covariance.ldlt().solve(Matrix6d::Identity());
  Vector6d error;
  error.head<3>() = pose.translation() - instant.position;
  error.tail<3>() = vectorFromMotion(instant.pose().inverse() * pose).tail<3>();
  prior.information += rows.transpose() * information * rows;
  prior.vector += rows.transpose() * information * error;
  const auto add = [&](const std::array<double, 3>& factors, const Vector6d& stddev) {
    Rows differences = Rows::Zero(6, prior.information.rows());
    Vector6d value = Vector6d::Zero();
    for (int i = 0; i < 3; ++i) {
      differences.middleCols<6>(columnOf(i)) = factors[i] * Matrix6d::Identity();
      Vector6d knot;
      knot << trajectory.knot(i).translation(),
          vectorFromMotion(trajectory.knot(0).inverse() * trajectory.knot(i)).tail<3>();
      value += factors[i] * knot;
    }
    const Vector6d weights = stddev.cwiseAbs2().cwiseInverse();
    prior.information += differences.transpose() * weights.asDiagonal() * differences;
    prior.vector -= differences.transpose() * weights.cwiseProduct(value);
  };
  const double interval = trajectory.interval();
  add({-1.0, 1.0, 0.0}, interval * velocity_stddev);
  add({1.0, -2.0, 1.0}, Vector6d::Constant(kAcceleration * interval * interval));
}

WindowMotion poseAt(const WindowProblem& problem, const WindowResult& result, double time) {
  const Trajectory::Instant at = problem.trajectory.at(time);
  Rows rows = byUnknowns(at, result.covariance.rows());
  rows.topRows<3>() = at.rotation.transpose() * rows.topRows<3>();
  return {at.pose(), carried(rows, result, at, at)};
}

WindowMotion motionBetween(const WindowProblem& problem, const WindowResult& result, double from, double to) {
  const Trajectory::Instant a = problem.trajectory.at(from), b = problem.trajectory.at(to);
  const Eigen::Isometry3d motion = a.pose().inverse() * b.pose();
  const Rows by_a = byUnknowns(a, result.covariance.rows());
  Rows rows = byUnknowns(b, result.covariance.rows());
  const Eigen::Matrix3d back = motion.linear().transpose();
  rows.topRows<3>() = b.rotation.transpose() * (rows.topRows<3>() - by_a.topRows<3>()) +
                      back * skew(motion.translation()) * by_a.bottomRows<3>();
  rows.bottomRows<3>() -= back * by_a.bottomRows<3>();
  return {motion, carried(rows, result, a, b)};
}

ExposureTwist twistAt(const WindowProblem& problem, const WindowResult& result, double time) {
  const Trajectory& trajectory = problem.trajectory;
  const Trajectory::Instant at = trajectory.at(time), before = trajectory.at(time - 2.0 * kStep),
                            after = trajectory.at(time + 2.0 * kStep);
  const Eigen::Matrix3d to_camera = at.rotation.transpose();
  const Eigen::Index unknowns = result.covariance.rows();
  ExposureTwist twist;
  twist.value << to_camera * at.velocity, at.rate;
  twist.acceleration << to_camera * at.acceleration, at.angular_acceleration;
  const Rows turned = byUnknowns(at, unknowns);
  const auto rows_of = [&](const Vector6d& value) {
    Rows rows = Rows::Zero(6, unknowns);
    rows.topRows<3>() = skew(value.head<3>()) * turned.bottomRows<3>();
    return rows;
  };
  const auto add_by_knot = [&](const Trajectory::Instant& instant, double factor, Rows& rows) {
    for (int i = 0; i < Trajectory::kSupport; ++i)
      rows.block<3, 3>(0, columnOf(instant.first + i)) += factor * instant.velocity_by_knot[i] * to_camera;
  };
  Rows by_velocity = rows_of(twist.value), by_acceleration = rows_of(twist.acceleration);
  add_by_knot(at, 1.0, by_velocity);
  add_by_knot(after, 0.25 / kStep, by_acceleration);
  add_by_knot(before, -0.25 / kStep, by_acceleration);
  by_velocity.bottomRows<3>() = rateByUnknowns(trajectory, time, unknowns);
  by_acceleration.bottomRows<3>() = (rateByUnknowns(trajectory, time + kStep, unknowns) -
                                     rateByUnknowns(trajectory, time - kStep, unknowns)) /
                                    (2.0 * kStep);
  twist.covariance = carried(by_velocity, result, before, after);
  twist.acceleration_covariance = carried(by_acceleration, result, before, after);
  return twist;
}

}  // namespace cartvo::vo
