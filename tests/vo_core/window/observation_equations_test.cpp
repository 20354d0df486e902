// Derivatives of the trajectory and of an observation's residuals against differences; elimination of
// landmarks.
#include "vo_core/window/observation_equations.hpp"

#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "vo_core/window/window_equations.hpp"

namespace cartvo::vo {
namespace {

constexpr double kStep = 1e-6;

Trajectory turningTrajectory() {
  Trajectory trajectory(0.0, 0.03, Eigen::Isometry3d::Identity());
  trajectory.extendTo(0.12);
  for (int i = 0; i < trajectory.size(); ++i) {
    Vector6d step;
    step << 0.02 * i, 0.01 * i * i, 0.12 * i, 0.02 * i, -0.03 * i + 0.004 * i * i, 0.01 * i * i;
    trajectory.move(i, step);
  }
  return trajectory;
}

/// Position in the world's axes and rotation on the right, from one instant of a trajectory to another's.
Vector6d changeOf(const Trajectory::Instant& from, const Trajectory::Instant& to) {
  Vector6d change;
  change << to.position - from.position, vectorFromMotion(from.pose().inverse() * to.pose()).tail<3>();
  return change;
}

TEST(Trajectory, DerivativesAreThoseOfDifferences) {
  const Trajectory trajectory = turningTrajectory();
  const Trajectory::Instant at = trajectory.at(0.047);
  EXPECT_EQ(at.first, 1);
  const Vector6d by_time =
      changeOf(trajectory.at(0.047 - kStep), trajectory.at(0.047 + kStep)) / (2.0 * kStep);
  EXPECT_LT((by_time.head<3>() - at.velocity).norm(), 1e-6);
  EXPECT_LT((by_time.tail<3>() - at.rate).norm(), 1e-6);
  const Trajectory::Instant before = trajectory.at(0.047 - kStep), after = trajectory.at(0.047 + kStep);
  EXPECT_LT(((after.velocity - before.velocity) / (2.0 * kStep) - at.acceleration).norm(), 1e-4);
  EXPECT_LT(((after.rate - before.rate) / (2.0 * kStep) - at.angular_acceleration).norm(), 1e-4);
  for (int i = 0; i < Trajectory::kSupport; ++i) {
    for (int axis = 0; axis < 6; ++axis) {
      Trajectory more = trajectory, less = trajectory;
      more.move(at.first + i, kStep * Vector6d::Unit(axis));
      less.move(at.first + i, -kStep * Vector6d::Unit(axis));
      const Vector6d numeric = changeOf(less.at(0.047), more.at(0.047)) / (2.0 * kStep);
      Vector6d expected = Vector6d::Zero();
      if (axis < 3)
        expected[axis] = at.by_knot[i];
      else
        expected.tail<3>() = at.turn_by_knot[i].col(axis - 3);
      EXPECT_LT((numeric - expected).norm(), 1e-6) << i << " " << axis;
    }
  }
}

TEST(Trajectory, ThirdDifferencesDeriveByKnots) {
  const Trajectory trajectory = turningTrajectory();
  const auto by_knot = trajectory.turnDifferencesByKnot(0);
  for (int i = 0; i < Trajectory::kSupport; ++i) {
    for (int axis = 3; axis < 6; ++axis) {
      Trajectory more = trajectory, less = trajectory;
      more.move(i, kStep * Vector6d::Unit(axis));
      less.move(i, -kStep * Vector6d::Unit(axis));
      const Vector6d numeric = (more.thirdDifferences(0) - less.thirdDifferences(0)) / (2.0 * kStep);
      EXPECT_LT((numeric.tail<3>() - by_knot[i].col(axis - 3)).norm(), 1e-6) << i << " " << axis;
    }
  }
}

TEST(Trajectory, KeepsItsCurveAsOldKnotsGo) {
  Trajectory trajectory = turningTrajectory();
  const Trajectory::Instant before = trajectory.at(0.1);
  trajectory.removeOldest(1);
  const Trajectory::Instant after = trajectory.at(0.1);
  EXPECT_LT(changeOf(before, after).norm(), 1e-12);
  EXPECT_LT((before.rate - after.rate).norm(), 1e-9);
  EXPECT_LT((before.turn_by_knot[2] - after.turn_by_knot[2]).norm(), 1e-9);
}

/// A landmark seen by both cameras of a pair, 10 ms apart.
struct Sight {
  WindowProblem problem;
  WindowBand band;
  WindowLandmark landmark;
  WindowObservation observation;

  Sight() {
    problem.camera = {480.0, 340.0, 210.0, 0.115, 680, 420};
    problem.pairs.push_back({0, 0.05, 0.01});
    problem.shared[kLeftReadout] = 0.03;
    problem.shared[kRightReadout] = 0.02;
    problem.noise[0].common = 0.3;
    const Trajectory trajectory = turningTrajectory();
    band.left_time = problem.leftTime(0, 0.1);
    band.right_time = problem.rightTime(0, 0.1);
    band.left = trajectory.at(band.left_time);
    band.right = trajectory.at(band.right_time);
    landmark.T_world_host = trajectory.at(0.02).pose();
    landmark.place << 0.2, -0.1, 0.15;
    observation.stereo = true;
    observation.left = {400.0, 150.0};
    observation.right = {380.0, 150.0};
    observation.left_share = observation.right_share = 0.1;
  }
  ObservationEquations equations() const {
    ObservationEquations result;
    EXPECT_TRUE(setEquations(problem, band, landmark, observation, 1.0, result));
    return result;
  }
  Eigen::Vector4d residual() const { return equations().residual(); }
};

TEST(ObservationEquations, RowsAwayFromTheMiddleOfTheirBandMoveWithAcceleration) {
  Sight sight;
  const Trajectory trajectory = turningTrajectory();
  for (const double share : {0.05, 0.15}) {
    sight.observation.left_share = sight.observation.right_share = share;
    Sight own = sight;
    own.band.left_time = own.problem.leftTime(0, share);
    own.band.right_time = own.problem.rightTime(0, share);
    own.band.left = trajectory.at(own.band.left_time);
    own.band.right = trajectory.at(own.band.right_time);
    EXPECT_LT((sight.residual() - own.residual()).norm(), 1e-3) << "px";
  }
}

template <typename Perturb>
Eigen::Vector4d differenceBy(const Sight& sight, const Perturb& perturb) {
  Sight more = sight, less = sight;
  perturb(more, kStep);
  perturb(less, -kStep);
  return (less.residual() - more.residual()) / (2.0 * kStep);  // of the prediction
}

TEST(ObservationEquations, DerivativesAreThoseOfDifferences) {
  Sight sight;  // at the predicted positions: readouts act at the rows of these
  sight.observation.left -= sight.residual().head<2>();
  sight.observation.right -= sight.residual().tail<2>();
  const ObservationEquations equations = sight.equations();
  const auto expect = [&](int state, const auto& perturb) {
    const Eigen::Vector4d numeric = differenceBy(sight, perturb);
    EXPECT_LT((numeric - equations.by_state.col(state)).norm(), 1e-2) << state;
  };
  expect(kRowLeftReadout, [](Sight& s, double step) { s.problem.shared[kLeftReadout] += step; });
  expect(kRowRightReadout, [](Sight& s, double step) { s.problem.shared[kRightReadout] += step; });
  expect(kRowOffset, [](Sight& s, double step) { s.problem.shared[kOffset] += step; });
  const auto turn = [](Trajectory::Instant& instant, int axis, double step) {
    instant.rotation *= motionFromVector(step * Vector6d::Unit(3 + axis)).linear();
    instant.velocity = instant.rotation * motionFromVector(-step * Vector6d::Unit(3 + axis)).linear() *
                       instant.rotation.transpose() * instant.velocity;
  };
  for (int axis = 0; axis < 3; ++axis) {
    expect(kRowLeftPosition + axis, [&](Sight& s, double step) { s.band.left.position[axis] += step; });
    expect(kRowRightPosition + axis, [&](Sight& s, double step) { s.band.right.position[axis] += step; });
    expect(kRowLeftTurn + axis, [&](Sight& s, double step) { turn(s.band.left, axis, step); });
    expect(kRowRightTurn + axis, [&](Sight& s, double step) { turn(s.band.right, axis, step); });
    EXPECT_LT((differenceBy(sight, [&](Sight& s, double step) { s.landmark.place[axis] += step; }) -
               equations.by_place.col(axis))
                  .norm(),
              1e-2);
  }
  for (int state = 0; state < kRigStates; ++state)
    expect(kRowRig + state, [&](Sight& s, double step) { s.problem.shared[kPitch + state] += step; });
}

/// Derivatives of an observation's residuals by all unknowns, from those by its states.
Eigen::MatrixXd byUnknowns(const Sight& sight, const ObservationEquations& equations) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(4, columnOf(sight.problem.trajectory.size()));
  const auto& by_state = equations.by_state;
  const auto add = [&](const Trajectory::Instant& instant, int position, int turn) {
    for (int i = 0; i < Trajectory::kSupport; ++i) {
      const Eigen::Index at = columnOf(instant.first + i);
      result.middleCols<3>(at) += instant.by_knot[i] * by_state.middleCols<3>(position);
      result.middleCols<3>(at + 3) += by_state.middleCols<3>(turn) * instant.turn_by_knot[i];
    }
  };
  add(sight.band.left, kRowLeftPosition, kRowLeftTurn);
  add(sight.band.right, kRowRightPosition, kRowRightTurn);
  result.col(kLeftReadout) = by_state.col(kRowLeftReadout);
  result.rightCols(result.cols() - kRightReadout).leftCols<kSharedStates - kRightReadout>() =
      by_state.middleCols<kSharedStates - kRightReadout>(kRowRightReadout);
  return result;
}

TEST(WindowEquations, EliminateLandmarks) {
  Sight sight;
  sight.problem.trajectory = turningTrajectory();
  sight.problem.pairs.push_back({1, 0.08, 0.01});
  Eigen::MatrixXd all;  // unknowns, then the landmark
  Eigen::VectorXd gradient;
  for (int pair = 0; pair < 2; ++pair) {
    sight.observation.pair = pair;
    sight.observation.stereo = pair == 0;
    sight.observation.left_share = sight.observation.right_share = 0.0;  // in the middle of a band
    sight.landmark.observations.push_back(sight.observation);
    sight.band.left_time = sight.problem.leftTime(pair, 0.0);
    sight.band.right_time = sight.problem.rightTime(pair, 0.0);
    sight.band.left = sight.problem.trajectory.at(sight.band.left_time);
    sight.band.right = sight.problem.trajectory.at(sight.band.right_time);
    const ObservationEquations equations = sight.equations();
    Eigen::MatrixXd rows(4, columnOf(sight.problem.trajectory.size()) + 3);
    rows << byUnknowns(sight, equations), equations.by_place;
    Eigen::Vector4d weight = kStudentInformation * equations.precision;
    for (int row = 0; row < 4; ++row)
      weight[row] *= studentWeight(equations.squareIn(row / 2));
    if (pair == 0) {
      all = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
      gradient = Eigen::VectorXd::Zero(rows.cols());
    }
    all += rows.transpose() * weight.asDiagonal() * rows;
    gradient += rows.transpose() * weight.cwiseProduct(equations.residual());
  }
  all.bottomRightCorner<1, 1>().array() += 1.0;  // of an inverse depth that nothing shows
  const Eigen::MatrixXd solved = all.bottomRightCorner<3, 3>().ldlt().solve(all.bottomRows<3>());
  const Eigen::Index unknowns = all.rows() - 3;
  const Eigen::MatrixXd information =
      all.topLeftCorner(unknowns, unknowns) - all.topRightCorner(unknowns, 3) * solved.leftCols(unknowns);
  const Eigen::VectorXd rest =
      gradient.head(unknowns) - solved.leftCols(unknowns).transpose() * gradient.tail<3>();

  WindowEquations equations;
  std::vector<WindowLandmark> landmarks{sight.landmark};
  equations.setLandmarks(sight.problem, landmarks, false, 1.0);
  EXPECT_LT((equations.information() - information).norm(), 1e-9 * all.norm());
  EXPECT_LT((equations.gradient() - rest).norm(), 1e-9 * gradient.norm());
  const Eigen::VectorXd step = 1e-3 * Eigen::VectorXd::LinSpaced(unknowns, -1.0, 1.0);
  equations.moveLandmarks(step, landmarks);
  const Eigen::Vector3d expected =
      all.bottomRightCorner<3, 3>().ldlt().solve(gradient.tail<3>()) - solved.leftCols(unknowns) * step;
  EXPECT_LT((landmarks[0].place - sight.landmark.place - expected).norm(), 1e-9 * expected.norm());
  const Eigen::MatrixXd regular = information + Eigen::MatrixXd::Identity(unknowns, unknowns);
  const Eigen::MatrixXd product = equations.covarianceBy(regular.llt().matrixL()) * regular;
  EXPECT_LT((product - Eigen::MatrixXd::Identity(unknowns, unknowns)).norm(), 1e-6);
}

}  // namespace
}  // namespace cartvo::vo
