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

PoseUncertainty propagate(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                          const Matrix6d& errors = noise()) {
  return afterMotion(before, motion, errors, UncertaintySettings());
}

double heightVariance(int pairs) {
  PoseUncertainty known;
  for (int pair = 0; pair < pairs; ++pair)
    known = propagate(known, Eigen::Isometry3d::Identity());
  return known.pose(1, 1);
}

TEST(PoseDrift, VarianceGrowsFasterThanLinearlyAtFirstAndLinearlyLater) {
  EXPECT_GT(heightVariance(20) / heightVariance(5), 8.0);
  EXPECT_NEAR(heightVariance(20'000) / heightVariance(10'000), 2.0, 0.05);
}

TEST(PoseDrift, HeadingErrorsBecomeLateralErrors) {
  PoseUncertainty known;
  known.pose(4, 4) = 1e-4;
  const Matrix6d nothing = Matrix6d::Zero();
  const Matrix6d carried = propagate(known, kAhead, nothing).pose;
  EXPECT_TRUE(carried.isApprox(composedCovariance(known.pose, kAhead, nothing)));
  EXPECT_NEAR(carried(0, 0), 0.3 * 0.3 * 1e-4, 1e-12);
}

TEST(PoseDrift, StaysPositiveDefiniteInCurves) {
  Vector6d curve;
  curve << 0.0, 0.0, 0.3, 0.001, 0.05, -0.002;
  PoseUncertainty known;
  double volume = 0.0;
  for (int pair = 0; pair < 500; ++pair) {
    known = propagate(known, motionFromVector(pair % 100 < 50 ? curve : Vector6d(-curve)));
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
