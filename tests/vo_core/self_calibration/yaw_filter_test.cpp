// Tests of the filter for yaw and p2 and of its correction.
#include "vo_core/self_calibration/yaw_filter.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"

namespace cartvo::vo {
namespace {

using Vector = RigCorrection::Vector;
using Matrix = RigCorrection::Matrix;

constexpr double kTimeStep = 0.055;  // s

/// Filter after `pairs` pairs, each of which measures yaw and p2 with these standard deviations.
YawFilter filterAfter(const Vector& truth, int pairs, const Vector& stddev = {1e-4, 2e-4}) {
  const Matrix information = stddev.cwiseAbs2().cwiseInverse().asDiagonal();
  YawFilter filter;
  for (int i = 0; i < pairs; ++i) {
    const RigCorrection applied = filter.correction();
    filter.update(information, information * (truth - Vector(applied.yaw, applied.p2)), applied, kTimeStep);
  }
  return filter;
}

TEST(YawFilter, CorrectsNothingInitially) {
  const YawFilter filter;
  EXPECT_EQ(filter.estimate(), Vector::Zero());
  EXPECT_EQ(filter.correction().yaw, 0.0);
  EXPECT_EQ(filter.correction().p2, 0.0);
  EXPECT_GT(filter.stddev().minCoeff(), 0.0);
}

TEST(YawFilter, ConvergesToTheTruth) {
  const Vector truth(4e-4, -7e-4);
  EXPECT_LT((filterAfter(truth, 3000).estimate() - truth).norm(), 1e-6);
}

TEST(YawFilter, PriorLimitsTheFirstPair) {
  EXPECT_LT(filterAfter({4e-4, 0.0}, 1, {1e-3, 1e-3}).estimate()[0], 0.5 * 4e-4);
}

TEST(YawFilter, StddevShrinksWithEachPair) {
  Vector before = YawFilter().stddev();
  for (const int pairs : {1, 2, 10, 100, 1000}) {
    const Vector now = filterAfter({4e-4, 0.0}, pairs).stddev();
    EXPECT_TRUE((now.array() < before.array()).all()) << pairs;
    before = now;
  }
}

TEST(YawFilter, CountsPairsAsCorrelated) {
  const double independent = 1e-4 / std::sqrt(1000.0);
  EXPECT_GT(filterAfter({4e-4, 0.0}, 1000).stddev()[0], 2.0 * independent);
}

TEST(YawFilter, CorrectsNothingWithinTheDeadZone) {
  const RigCorrection correction = filterAfter({1.5e-5, -1.5e-5}, 3000).correction();
  EXPECT_EQ(correction.yaw, 0.0);
  EXPECT_EQ(correction.p2, 0.0);
}

TEST(YawFilter, CorrectsErrorsBeyondTheDeadZoneWithTheirSign) {
  for (const double sign : {-1.0, 1.0}) {
    const RigCorrection correction = filterAfter({sign * 4e-4, -sign * 7e-4}, 3000).correction();
    EXPECT_NEAR(correction.yaw, sign * 4e-4, 4e-6);
    EXPECT_NEAR(correction.p2, -sign * 7e-4, 4e-6);
  }
}

TEST(YawFilter, CorrectsLittleJustBeyondTheDeadZone) {
  EXPECT_LT(filterAfter({3.2e-5, 0.0}, 3000).correction().yaw, 5e-6);
}

TEST(YawFilter, LimitsTheCorrection) {
  for (const double sign : {-1.0, 1.0}) {
    const YawFilter filter = filterAfter({sign * 0.02, sign * 0.02}, 3000);
    EXPECT_NEAR(filter.estimate()[0], sign * 0.02, 1e-3);  // the estimate is not limited
    EXPECT_DOUBLE_EQ(filter.correction().yaw, sign * 1e-2);
    EXPECT_DOUBLE_EQ(filter.correction().p2, sign * 3e-3);
  }
}

TEST(YawFilter, IgnoresNan) {
  YawFilter filter = filterAfter({4e-4, 0.0}, 10);
  const Vector estimate = filter.estimate();
  const Vector stddev = filter.stddev();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  filter.update(Matrix::Identity() * 1e6, Vector(nan, 0.0), {}, kTimeStep);
  filter.update(Matrix::Identity() * nan, Vector(1.0, 0.0), {}, kTimeStep);
  EXPECT_EQ(filter.estimate(), estimate);
  EXPECT_EQ(filter.stddev(), stddev);
}

TEST(YawFilter, FindsABumpAfterALongDrive) {
  YawFilter filter = filterAfter(Vector::Zero(), 20'000);
  const Vector bumped(5e-3, 0.0);
  const Matrix information = Vector(1e8, 2.5e7).asDiagonal();
  for (int i = 0; i < 400; ++i) {  // 22 s
    const RigCorrection applied = filter.correction();
    filter.update(information, information * (bumped - Vector(applied.yaw, applied.p2)), applied, kTimeStep);
  }
  EXPECT_NEAR(filter.estimate()[0], bumped[0], 1e-4);
}

TEST(YawFilter, DiscardsInformationAfterAYawStep) {
  YawFilter filter = filterAfter({4e-4, 0.0}, 3000);
  filter.applyYawStep(2e-3);
  EXPECT_NEAR(filter.estimate()[0], 2.4e-3, 1e-5);
  EXPECT_EQ(filter.stddev(), YawFilter().stddev());
}

/// Filter after a drive with a wrongly calibrated rig, each pair corrected by the estimate so far.
YawFilter driven(const RigCorrection& rig, double offset, int pairs) {
  YawFilter filter;
  for (int i = 0; i < pairs; ++i) {
    BundleProblem problem = test::simulateProblem({.offset = offset, .noise = 1.0, .rig = rig}, 1 + i);
    const RigCorrection found{filter.estimate()[0], filter.estimate()[1]};
    for (BundleLandmark& landmark : problem.landmarks)
      for (BundleObservation& observation : landmark.observations)
        observation.right = correctedRight(problem.camera, found, observation.right);
    const BundleResult result = test::adjustBundle(problem, BundleSettings{});
    EXPECT_TRUE(result.converged);
    filter.update(result.rig_information, result.rig_gradient, found, kTimeStep);
  }
  return filter;
}

void expectFound(const RigCorrection& rig, double offset) {
  const YawFilter filter = driven(rig, offset, 150);
  EXPECT_LT(filter.stddev().maxCoeff(), 3e-5);
  EXPECT_LT(std::abs(filter.estimate()[0] - rig.yaw), filter.stddev()[0]) << offset;
  EXPECT_LT(std::abs(filter.estimate()[1] - rig.p2), filter.stddev()[1]) << offset;
}

TEST(YawFilter, FindsAnInjectedYawFromBundleAdjustments) {
  expectFound({.yaw = 5e-4, .p2 = 0.0}, 0.0);
  expectFound({.yaw = -5e-4, .p2 = 0.0}, 0.02);
}

TEST(YawFilter, FindsAnInjectedP2FromBundleAdjustments) {
  expectFound({.yaw = 0.0, .p2 = 1e-3}, 0.0);
}

TEST(YawFilter, FindsNoErrorOfACorrectRig) {
  expectFound({}, 0.0);
  expectFound({}, 0.02);
}

}  // namespace
}  // namespace cartvo::vo
