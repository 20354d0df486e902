// Tests of the propagation of pose covariances.
#include "vo_core/geometry/pose_drift.hpp"

#include <Eigen/Eigenvalues>

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

const Eigen::Isometry3d kAhead(Eigen::Translation3d(0.0, 0.0, 0.3));

Matrix6d noise() {
  Vector6d variances;
  variances << 1e-8, 2e-8, 4e-8, 1e-10, 2e-10, 3e-10;
  return variances.asDiagonal();
}

MotionErrors errorsOf(int pairs, double patch_motion = 1.0) {
  return {pairs, noise(), patch_motion};
}

PoseUncertainty propagate(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                          const MotionErrors& errors) {
  return afterMotion(before, motion, errors, UncertaintySettings());
}

PoseUncertainty afterPairs(int pairs, const Eigen::Isometry3d& motion, double patch_motion = 1.0) {
  PoseUncertainty known;
  for (int pair = 0; pair < pairs; ++pair)
    known = propagate(known, motion, errorsOf(1, patch_motion));
  return known;
}

double heightVariance(int pairs, double patch_motion = 1.0) {
  return afterPairs(pairs, Eigen::Isometry3d::Identity(), patch_motion).pose(1, 1);
}

TEST(PoseDrift, FirstPoseHasLittleMoreThanItsNoise) {
  EXPECT_GT(heightVariance(1), 0.1 * noise()(1, 1));
  EXPECT_LT(heightVariance(1), 2.0 * noise()(1, 1));
}

TEST(PoseDrift, VarianceGrowsFasterThanLinearlyAtFirstAndLinearlyLater) {
  EXPECT_GT(heightVariance(20) / heightVariance(5), 8.0);
  EXPECT_NEAR(heightVariance(20'000) / heightVariance(10'000), 2.0, 0.05);
}

TEST(PoseDrift, IsSmallWithLittleImageMotion) {
  EXPECT_LT(heightVariance(30, 0.25), 0.5 * heightVariance(30, 1.0));
  EXPECT_NEAR(heightVariance(30, 0.0), 30.0 * heightVariance(1, 0.0), 1e-15);
}

TEST(PoseDrift, BuildsUpAfterAStandstill) {
  PoseUncertainty known;
  for (int pair = 0; pair < 100; ++pair)
    known = propagate(known, Eigen::Isometry3d::Identity(), errorsOf(1, 0.001));
  const double at_standstill = known.pose(1, 1);
  for (int pair = 0; pair < 10; ++pair)
    known = propagate(known, Eigen::Isometry3d::Identity(), errorsOf(1));
  EXPECT_LT(known.pose(1, 1) - at_standstill, 0.7 * heightVariance(10));
}

TEST(PoseDrift, HeadingErrorsBecomeLateralErrors) {
  PoseUncertainty known;
  known.pose(4, 4) = 1e-4;
  const Matrix6d nothing = Matrix6d::Zero();
  const Matrix6d carried = propagate(known, kAhead, {1, nothing, 1.0}).pose;
  EXPECT_TRUE(carried.isApprox(composedCovariance(known.pose, kAhead, nothing)));
  EXPECT_NEAR(carried(0, 0), 0.3 * 0.3 * 1e-4, 1e-12);
}

TEST(PoseDrift, MotionOverTwoPairsDriftsLikeTwoMotions) {
  const PoseUncertainty before = afterPairs(30, kAhead);
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  const PoseUncertainty between = propagate(before, still, errorsOf(1));
  const PoseUncertainty one_by_one = propagate(between, still, errorsOf(1));
  const PoseUncertainty at_once = propagate(before, still, errorsOf(2));
  EXPECT_TRUE(at_once.drift.isApprox(one_by_one.drift));
  EXPECT_TRUE(at_once.pose_and_drift.isApprox(one_by_one.pose_and_drift));
  // The intermediate pose adds its own noise.
  EXPECT_LT(at_once.pose(0, 0), one_by_one.pose(0, 0));
  EXPECT_NEAR(at_once.pose(0, 0), one_by_one.pose(0, 0), noise()(0, 0));
}

TEST(PoseDrift, StaysPositiveDefiniteInCurves) {
  Vector6d curve;
  curve << 0.0, 0.0, 0.3, 0.001, 0.05, -0.002;
  PoseUncertainty known;
  double volume = 0.0;
  for (int pair = 0; pair < 500; ++pair) {
    known = propagate(known, motionFromVector(pair % 100 < 50 ? curve : Vector6d(-curve)), errorsOf(1));
    Eigen::Matrix<double, 12, 12> all;
    all << known.pose, known.pose_and_drift, known.pose_and_drift.transpose(), known.drift;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> solver(all);
    ASSERT_GT(solver.eigenvalues().minCoeff(), -1e-9 * solver.eigenvalues().maxCoeff()) << pair;
    const double now = known.pose.determinant();
    ASSERT_GT(now, volume) << pair;
    volume = now;
  }
}

}  // namespace
}  // namespace cartvo::vo
