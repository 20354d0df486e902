// Tests of the motion about an exposure: row shifts, and its estimation from the rows of a simulated pair.
#include "vo_core/rolling_shutter/row_motion.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/rolling_shutter/motion_prediction.hpp"
#include "vo_core/rolling_shutter/motion_roughness.hpp"
#include "vo_core/shutter.hpp"

namespace cartvo::vo {
namespace {

using test::kRigCamera;
using test::vector6;

constexpr double kReadout = 0.032, kPeriod = 0.055;  // s

/// A turning and braking cart with some pitch; the camera is at the identity at the exposure.
const ExposureMotion kTurn{vector6(0.1, -0.05, 4.0, 0.08, 0.5, -0.06),
                           vector6(0.4, 0.2, -2.0, 0.9, 1.2, -0.5)};

/// Pixel and instant (s after the exposure) at which a camera with a rolling shutter sees a point.
struct RowView {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double instant = 0.0;
};
RowView seeRow(const ExposureMotion& motion, double offset, double baseline, double readout,
               const Eigen::Vector3d& point) {
  RowView view;
  const Eigen::Translation3d T_left_right(baseline, 0.0, 0.0);
  for (int i = 0; i < 20; ++i) {
    view.pixel = project(kRigCamera, (motion.at(offset + view.instant) * T_left_right).inverse() * point);
    view.instant = readout * RowShares().at(view.pixel, kRigCamera.height);
  }
  return view;
}

/// Points in front of the camera that all rows of both cameras see.
std::vector<Eigen::Vector3d> visiblePoints(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> column(40.0, kRigCamera.width - 20.0),
      row(5.0, kRigCamera.height - 5.0), inverse_depth(0.02, 0.3);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(bearingOf(kRigCamera, {column(random), row(random)}) / inverse_depth(random));
  return points;
}

RowMotionProblem simulatedProblem(const ExposureMotion& motion, double noise) {
  std::mt19937 random(3);
  std::normal_distribution<double> error(0.0, noise);
  RowMotionProblem problem;
  problem.camera = kRigCamera;
  problem.expected = problem.start = motion;
  problem.variances.setConstant(1e4);
  const Eigen::Isometry3d T_camera_anchor = motion.at(-kPeriod);
  for (const Eigen::Vector3d& place : visiblePoints(400)) {
    const Eigen::Vector3d in_anchor = T_camera_anchor.inverse() * place;
    const RowView seen = seeRow(motion, 0.0, 0.0, kReadout, place);
    RowPoint& point = problem.points.emplace_back();
    point.bearing = in_anchor / in_anchor.z();
    point.inverse_depth = 1.0 / in_anchor.z();
    point.ray = point.inverse_depth * place;
    point.ray_by_inverse_depth = T_camera_anchor.translation();
    point.inverse_depth_information = 1e6;
    point.pixel = seen.pixel + Eigen::Vector2d(error(random), error(random));
    point.instant = seen.instant;
    point.share = seen.instant / kReadout;
  }
  return problem;
}

TEST(RowShift, MovesAPixelToWhereItIsSeenAtTheExposure) {
  for (const Eigen::Vector3d& point : visiblePoints(50)) {
    const RowView row = seeRow(kTurn, 0.0, 0.0, kReadout, point);
    const Eigen::Vector2d at_exposure =
        pixelAtExposure(kRigCamera, kTurn, row.instant, row.pixel, 1.0 / point.z());
    EXPECT_LT((at_exposure - project(kRigCamera, point)).norm(), 2e-3);
  }
}

TEST(RowShift, OfTheRightCameraFollowsTheMotionAboutItsOwnExposure) {
  constexpr double kOffset = 0.025;
  const Eigen::Isometry3d T_left_right(Eigen::Translation3d(kRigCamera.baseline, 0.0, 0.0));
  const ExposureMotion right = motionAbout(kTurn, kOffset, T_left_right, 0.5 * kReadout);
  for (const Eigen::Vector3d& point : visiblePoints(50)) {
    const RowView row = seeRow(kTurn, kOffset, kRigCamera.baseline, kReadout, point);
    const Eigen::Vector3d in_right = (kTurn.at(kOffset) * T_left_right).inverse() * point;
    const Eigen::Vector2d at_exposure =
        pixelAtExposure(kRigCamera, right, row.instant, row.pixel, 1.0 / in_right.z());
    EXPECT_LT((at_exposure - project(kRigCamera, in_right)).norm(), 5e-3);
  }
}

TEST(RowMotion, IsExactWithoutNoise) {
  RowMotionProblem problem = simulatedProblem(kTurn, 0.0);
  problem.start = {kTurn.velocity + vector6(0.02, 0.03, 0.2, 0.05, -0.1, 0.05), Vector6d::Zero()};
  const RowMotion found = RowMotionEstimator().estimate(problem);
  ASSERT_TRUE(found.converged);
  EXPECT_LT((found.motion.velocity - kTurn.velocity).tail<3>().norm(), 2e-3);
  EXPECT_LT((found.motion.velocity - kTurn.velocity).head<3>().norm(), 2e-2);
}

TEST(RowMotion, MeasuresTheJerkOfAVibration) {
  ExposureMotion shaken = kTurn;
  shaken.angular_jerk = {600.0, 0.0, -300.0};
  RowMotionProblem problem = simulatedProblem(shaken, 0.15);
  problem.start = problem.expected = kTurn;
  problem.variances.setConstant(1e6);
  const RowMotion found = RowMotionEstimator().estimate(problem);
  ASSERT_TRUE(found.converged);
  const Eigen::Vector3d error = found.motion.angular_jerk - shaken.angular_jerk;
  EXPECT_LT(error.norm(), 0.5 * shaken.angular_jerk.norm());
  EXPECT_LT(error.dot(found.covariance.bottomRightCorner<3, 3>().ldlt().solve(error)), 12.0);  // of 3
}

TEST(RowMotion, StatesItsUncertainty) {
  const RowMotion found = RowMotionEstimator().estimate(simulatedProblem(kTurn, 0.15));
  ASSERT_TRUE(found.converged);
  const Vector6d error = found.motion.velocity - kTurn.velocity;
  EXPECT_LT(error.dot(found.covariance.topLeftCorner<6, 6>().ldlt().solve(error)), 18.0);  // of 6
  EXPECT_LT(std::sqrt(found.covariance(4, 4)), 0.01);
}

TEST(RowMotion, FollowsAKickThatThePriorContradicts) {
  ExposureMotion kick = kTurn;
  kick.velocity[3] += 0.5;  // rad/s
  RowMotionProblem problem = simulatedProblem(kick, 0.15);
  problem.expected = problem.start = kTurn;
  problem.variances.setConstant(1e-4);  // of a smooth drive
  const RowMotion found = RowMotionEstimator().estimate(problem);
  ASSERT_TRUE(found.converged);
  EXPECT_NEAR(found.motion.velocity[3], kick.velocity[3], 0.02);
}

TEST(RowMotion, TellsTheReadoutWhereTheMotionIsKnown) {
  RowMotionProblem problem = simulatedProblem(kTurn, 0.15);
  problem.variances.setConstant(1e-6);
  for (RowPoint& point : problem.points)
    point.instant = 0.9 * kReadout * point.share;
  const RowMotion found = RowMotionEstimator().estimate(problem);
  ASSERT_TRUE(found.converged);
  const double stddev = 1.0 / std::sqrt(found.readout.information);
  EXPECT_LT(stddev, 5e-4);
  EXPECT_NEAR(found.readout.gradient / found.readout.information, 0.1 * kReadout, 3.0 * stddev);
}

TEST(RowMotion, NeedsPoints) {
  RowMotionProblem problem = simulatedProblem(kTurn, 0.0);
  problem.points.resize(10);
  EXPECT_FALSE(RowMotionEstimator().estimate(problem).converged);
}

/// Information of rows that measure each component of a motion with this standard deviation.
RowInformation rowsAbout(const ExposureMotion& motion, double stddev) {
  RowInformation rows;
  rows.information.diagonal().setConstant(1.0 / (stddev * stddev));
  rows.gradient = rows.information * vectorOf(motion);
  return rows;
}

MotionPrior priorAbout(const ExposureMotion& motion, double variance) {
  return {vectorOf(motion), RowInformation::Vector::Constant(variance), 4.0};
}

TEST(MotionBlend, WeighsRowsAndTheExpectedMotionByTheirCovariances) {
  ExposureMotion seen = kTurn;
  seen.velocity[4] += 0.01;
  MotionPrior prior = priorAbout(kTurn, 1e-4);
  prior.freedom = 1e9;  // a normal distribution
  const MotionBlend blend(rowsAbout(seen, 0.01), prior);
  EXPECT_NEAR(blend.of(kTurn).velocity[4], kTurn.velocity[4] + 0.005, 1e-4);
  EXPECT_NEAR(blend.covariance(4, 4), 0.5e-4, 1e-6);
}

TEST(MotionBlend, IsTheExpectedMotionWhereRowsAreNoNumbers) {
  RowInformation rows = rowsAbout(kTurn, 0.01);
  rows.information(4, 4) = std::nan("");
  const MotionBlend blend(rows, priorAbout(kTurn, 1e-4));
  EXPECT_TRUE(blend.expected_share.isIdentity());
  EXPECT_EQ(blend.of(kTurn).velocity, kTurn.velocity);
  EXPECT_EQ(blend.covariance(4, 4), 1e-4);
}

TEST(MotionBlend, TakesADifferenceByChanceForNone) {
  ExposureMotion seen = kTurn;
  seen.velocity[4] += 0.03;  // three standard deviations of one component
  const MotionBlend blend(rowsAbout(seen, 0.01), priorAbout(kTurn, 1e-8));
  EXPECT_TRUE(blend.expected_share.isIdentity(1e-3));
  EXPECT_NEAR(blend.of(kTurn).velocity[4], kTurn.velocity[4], 1e-4);
}

// Errors of a video's rows reach five standard deviations; a smooth drive has no such changes of motion.
TEST(MotionBlend, NeedsTheMoreEvidenceTheSmootherTheDrive) {
  ExposureMotion seen = kTurn;
  seen.velocity[0] += 0.5;
  const RowInformation rows = rowsAbout(seen, 0.1);
  const MotionBlend smooth(rows, priorAbout(kTurn, 1e-6));
  EXPECT_TRUE(smooth.expected_share.isIdentity(1e-3));
  const MotionBlend rough(rows, priorAbout(kTurn, 1e-2));
  EXPECT_FALSE(rough.expected_share.isIdentity(1e-3));
  EXPECT_GT(rough.of(kTurn).velocity[0], kTurn.velocity[0] + 0.2);
}

TEST(MotionBlend, FollowsRowsThatContradictTheExpectedMotion) {
  ExposureMotion seen = kTurn;
  seen.velocity.tail<3>() += Eigen::Vector3d(0.2, -0.1, 0.1);
  const MotionBlend blend(rowsAbout(seen, 0.01), priorAbout(kTurn, 1e-8));
  EXPECT_FALSE(blend.expected_share.isIdentity(1e-3));
  const Vector6d error = blend.of(kTurn).velocity - seen.velocity;
  EXPECT_LT(error.tail<3>().norm(), 0.01);  // the standard deviation of the rows
  EXPECT_LT(std::sqrt(blend.covariance(3, 3)), 0.011);
}

TEST(MotionRoughness, WidensCovariancesWhereMotionsAndPosesDisagree) {
  MotionRoughness agreeing({}, 10.0), disagreeing({}, 10.0);
  const Vector6d variances = Vector6d::Constant(1e-6);
  Vector6d difference = Vector6d::Constant(0.5e-3);
  for (int i = 0; i < 50; ++i) {
    agreeing.compare(difference, variances);
    difference[3] = i % 2 == 0 ? 4e-3 : -4e-3;
    disagreeing.compare(difference, variances);
    difference[3] = 0.5e-3;
  }
  EXPECT_EQ(agreeing.varianceFactor(), 1.0);
  EXPECT_NEAR(disagreeing.varianceFactor(), 16.0, 0.2);
}

constexpr double kTimeStep = 0.05;  // s
using Height = std::function<double(double)>;

/// Poses of 5 pairs, the last of them at the instant `end`, that move along y only, to `height(time)`.
std::vector<TimedPose> posesUntil(double end, const Height& height) {
  std::vector<TimedPose> poses(5);
  for (int i = 0; i < 5; ++i) {
    poses[i].time = end + kTimeStep * (i - 4);
    poses[i].T_world_camera.translation().y() = height(poses[i].time);
  }
  return poses;
}

/// The standard deviation of the velocity of the newest pose after 50 pairs.
Vector6d stddevOfVelocity(const Vector6d& motion_stddev, const Height& height) {
  MotionRoughness roughness({}, 10.0);
  for (int i = 0; i < 50; ++i)
    roughness.update(posesUntil(kTimeStep * i, height), motion_stddev);
  return roughness.variances(posesUntil(kTimeStep * 49, height), 4, motion_stddev).head<6>().cwiseSqrt();
}

TEST(MotionRoughness, MeasuresTheJerkOfEachAxis) {
  constexpr double kJerk = 12.0;  // m/s^3
  const Vector6d stddev =
      stddevOfVelocity(Vector6d::Zero(), [](double time) { return kJerk / 6.0 * time * time * time; });
  // The velocity that the parabola through the last three poses has at the newest errs by jerk h^2 / 3.
  EXPECT_NEAR(stddev[1], kJerk * kTimeStep * kTimeStep / 3.0, 1e-4);
  for (const int smooth : {0, 2, 3, 4, 5})
    EXPECT_LT(stddev[smooth], 2e-4) << "axis " << smooth;
}

TEST(MotionRoughness, TakesTheNoiseOfPosesForNoJerk) {
  constexpr double kPoseStddev = 1e-4;  // m
  constexpr int kPairs = 4000;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, kPoseStddev);
  std::vector<TimedPose> poses(4);
  const Vector6d motion_stddev = Vector6d::Constant(std::sqrt(2.0) * kPoseStddev);
  MotionRoughness roughness({}, 1000.0);
  for (int i = 0; i < kPairs; ++i) {
    std::rotate(poses.begin(), poses.begin() + 1, poses.end());
    poses.back().time = kTimeStep * i;
    poses.back().T_world_camera.translation().y() = noise(random);
    if (i >= 4) roughness.update(poses, motion_stddev);
  }
  // Of an older pair, whose jerk is the mean; the noise alone would be a jerk of these squares.
  const double by_noise = 20.0 * std::pow(kPoseStddev, 2) / std::pow(kTimeStep, 6);
  const double near_far_sixth = kTimeStep * kTimeStep / 6.0;
  const double velocity_noise =
      roughness.variances(poses, 1, Vector6d::Zero())[1] / std::pow(near_far_sixth, 2);
  EXPECT_LT(velocity_noise, 0.2 * by_noise);
}

// A jerk of zero would be an infinite information.
TEST(MotionRoughness, IsNeverCertainThatThereIsNoJerk) {
  MotionRoughness roughness({}, 10.0);
  const Vector6d noisy = Vector6d::Constant(0.01);  // more than the poses show
  const auto steady = [](double) { return 0.0; };
  for (int i = 0; i < 50; ++i)
    roughness.update(posesUntil(kTimeStep * i, steady), noisy);
  const RowInformation::Vector variances =
      roughness.variances(posesUntil(kTimeStep * 49, steady), 4, Vector6d::Zero());
  EXPECT_GT(variances.minCoeff(), 0.0);
}

TEST(MotionRoughness, TakesTheNewestJerkAtOnce) {
  MotionRoughness roughness({}, 10.0);
  const auto kerb = [](double time) { return time > 2.41 ? 0.02 : 0.0; };  // m, from the last pose on
  for (int i = 0; i < 50; ++i)
    roughness.update(posesUntil(kTimeStep * i, kerb), Vector6d::Zero());
  const Vector6d variances =
      roughness.variances(posesUntil(kTimeStep * 49, kerb), 4, Vector6d::Zero()).head<6>();
  EXPECT_NEAR(std::sqrt(variances[1]), 0.02 / kTimeStep / 3.0, 1e-3);
}

/// Lets `errors` learn from motions with these velocities along x, one per period, each predicted from the
/// previous ones. Returns the prediction of the last one.
PredictedMotion predictLast(const std::vector<double>& velocities, PredictionErrors& errors) {
  PredictedMotion predicted;
  for (std::size_t i = 2; i < velocities.size(); ++i) {
    MotionPredictions predictions;
    predictions.time_step = kPeriod;
    predictions.extrapolated[0] = 2.0 * velocities[i - 1] - velocities[i - 2];
    for (std::size_t j = 0; j < i; ++j)
      predictions.mean[0] += velocities[j] / static_cast<double>(i);
    predicted = errors.combine(predictions);
    ExposureMotion found;
    found.velocity[0] = velocities[i];
    errors.update(predictions, found);
  }
  return predicted;
}

TEST(PredictionErrors, ExtrapolatesASteadyAcceleration) {
  std::vector<double> velocities;
  for (int i = 0; i < 30; ++i)
    velocities.push_back(0.1 * i);
  PredictionErrors errors(10.0);
  const PredictedMotion predicted = predictLast(velocities, errors);
  EXPECT_NEAR(predicted.motion[0], velocities.back(), 1e-6);
  EXPECT_LT(predicted.variances[0], 1e-6);
}

TEST(PredictionErrors, TakeTheMeanOfAFastVibration) {
  std::vector<double> velocities;
  double squares = 0.0;
  for (int i = 0; i < 60; ++i) {
    velocities.push_back(1.0 + std::sin(2.0 * M_PI * 12.0 * kPeriod * i));
    squares += std::pow(velocities.back() - 1.0, 2) / 60.0;
  }
  PredictionErrors errors(10.0);
  const PredictedMotion predicted = predictLast(velocities, errors);
  EXPECT_NEAR(predicted.motion[0], 1.0, 0.3);
  EXPECT_NEAR(predicted.variances[0], squares, 0.4 * squares);
}

TEST(PredictionErrors, TrustAnExtrapolationLessAfterAGap) {
  std::vector<double> velocities;
  for (int i = 0; i < 60; ++i)
    velocities.push_back(std::sin(2.0 * M_PI * 2.0 * kPeriod * i));
  PredictionErrors errors(10.0);
  const PredictedMotion usual = predictLast(velocities, errors);
  MotionPredictions predictions;
  predictions.extrapolated[0] = 1.0;
  predictions.time_step = kPeriod;
  const double share = errors.combine(predictions).motion[0];
  predictions.time_step = 4.0 * kPeriod;
  EXPECT_GT(share, 0.5);
  EXPECT_LT(errors.combine(predictions).motion[0], 0.5 * share);
  EXPECT_GT(errors.combine(predictions).variances[0], 2.0 * usual.variances[0]);
}

}  // namespace
}  // namespace cartvo::vo
