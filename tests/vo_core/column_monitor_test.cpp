// What disparities tell of yaw and bend, and how much of it is used.
#include "vo_core/column_monitor.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "vo_core/landmark_scene.hpp"

namespace cartvo {
namespace {

using Vector = RigCorrection::Vector;
using Matrix = RigCorrection::Matrix;

constexpr double kTimeStep = 0.055;  // s

/// A monitor that has seen `pairs` pairs, each of which tells yaw and bend with these deviations.
ColumnMonitor told(const Vector& truth, int pairs, const Vector& deviations = {1e-4, 2e-4}) {
  const Matrix information = deviations.cwiseAbs2().cwiseInverse().asDiagonal();
  ColumnMonitor monitor;
  for (int i = 0; i < pairs; ++i) {
    const RigCorrection applied = monitor.correction();
    monitor.add(information, information * (truth - Vector(applied.yaw, applied.bend)), applied, kTimeStep);
  }
  return monitor;
}

TEST(ColumnMonitor, CorrectsNothingToBeginWith) {
  const ColumnMonitor monitor;
  EXPECT_EQ(monitor.estimate(), Vector::Zero());
  EXPECT_EQ(monitor.correction().yaw, 0.0);
  EXPECT_EQ(monitor.correction().bend, 0.0);
  EXPECT_GT(monitor.deviation().minCoeff(), 0.0);
}

TEST(ColumnMonitor, ConvergesToWhatThePairsTell) {
  const Vector truth(4e-4, -7e-4);
  EXPECT_LT((told(truth, 3000).estimate() - truth).norm(), 1e-6);
}

TEST(ColumnMonitor, FirstPairsAreNotTakenAtTheirWord) {
  EXPECT_LT(told({4e-4, 0.0}, 1, {1e-3, 1e-3}).estimate()[0], 0.5 * 4e-4);
}

TEST(ColumnMonitor, DeviationShrinksWithEachPair) {
  Vector before = ColumnMonitor().deviation();
  for (const int pairs : {1, 2, 10, 100, 1000}) {
    const Vector now = told({4e-4, 0.0}, pairs).deviation();
    EXPECT_TRUE((now.array() < before.array()).all()) << pairs;
    before = now;
  }
}

TEST(ColumnMonitor, ManyPairsTellLessThanAsManyIndependentOnes) {
  const double independent = 1e-4 / std::sqrt(1000.0);
  EXPECT_GT(told({4e-4, 0.0}, 1000).deviation()[0], 2.0 * independent);
}

TEST(ColumnMonitor, CorrectsNoneOfWhatAnyCalibrationLeavesOver) {
  const RigCorrection correction = told({1.5e-5, -1.5e-5}, 3000).correction();
  EXPECT_EQ(correction.yaw, 0.0);
  EXPECT_EQ(correction.bend, 0.0);
}

TEST(ColumnMonitor, CorrectsWhatIsBeyondWithItsSign) {
  for (const double sign : {-1.0, 1.0}) {
    const RigCorrection correction = told({sign * 4e-4, -sign * 7e-4}, 3000).correction();
    EXPECT_NEAR(correction.yaw, sign * 4e-4, 4e-6);
    EXPECT_NEAR(correction.bend, -sign * 7e-4, 4e-6);
  }
}

TEST(ColumnMonitor, CorrectsLittleOfWhatIsHardlyBeyond) {
  EXPECT_LT(told({3.2e-5, 0.0}, 3000).correction().yaw, 5e-6);
}

TEST(ColumnMonitor, DoesNotCorrectMoreThanARigMayHaveComeTo) {
  for (const double sign : {-1.0, 1.0}) {
    const ColumnMonitor monitor = told({sign * 0.02, sign * 0.02}, 3000);
    EXPECT_NEAR(monitor.estimate()[0], sign * 0.02, 1e-3);  // it is said, though
    EXPECT_DOUBLE_EQ(monitor.correction().yaw, sign * 1e-2);
    EXPECT_DOUBLE_EQ(monitor.correction().bend, sign * 3e-3);
  }
}

TEST(ColumnMonitor, WhatIsNotANumberLeavesItAsItWas) {
  ColumnMonitor monitor = told({4e-4, 0.0}, 10);
  const Vector estimate = monitor.estimate();
  const Vector deviation = monitor.deviation();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  monitor.add(Matrix::Identity() * 1e6, Vector(nan, 0.0), {}, kTimeStep);
  monitor.add(Matrix::Identity() * nan, Vector(1.0, 0.0), {}, kTimeStep);
  EXPECT_EQ(monitor.estimate(), estimate);
  EXPECT_EQ(monitor.deviation(), deviation);
}

TEST(ColumnMonitor, ABumpIsFoundAfterALongDriveToo) {
  ColumnMonitor monitor = told(Vector::Zero(), 20'000);
  const Vector bumped(5e-3, 0.0);
  const Matrix information = Vector(1e8, 2.5e7).asDiagonal();
  for (int i = 0; i < 400; ++i) {  // 22 s
    const RigCorrection applied = monitor.correction();
    monitor.add(information, information * (bumped - Vector(applied.yaw, applied.bend)), applied, kTimeStep);
  }
  EXPECT_NEAR(monitor.estimate()[0], bumped[0], 1e-4);
}

TEST(ColumnMonitor, AfterATurnItLearnsAnew) {
  ColumnMonitor monitor = told({4e-4, 0.0}, 3000);
  monitor.turn(2e-3);
  EXPECT_NEAR(monitor.estimate()[0], 2.4e-3, 1e-5);
  EXPECT_EQ(monitor.deviation(), ColumnMonitor().deviation());
}

/// A drive with a rig that is off its calibration, each pair corrected by what the monitor has found so far.
ColumnMonitor driven(const RigCorrection& rig, double offset, int pairs) {
  ColumnMonitor monitor;
  for (int i = 0; i < pairs; ++i) {
    BundleProblem problem = test::seenBy({.offset = offset, .noise = 1.0, .rig = rig}, 1 + i);
    const RigCorrection found{monitor.estimate()[0], monitor.estimate()[1]};
    for (BundleLandmark& landmark : problem.landmarks)
      for (BundleSighting& sighting : landmark.sightings)
        sighting.right = correctedRight(problem.camera, found, sighting.right);
    const BundleResult result = test::adjustBundle(problem, BundleSettings{});
    EXPECT_TRUE(result.converged);
    monitor.add(result.rig_information, result.rig_gradient, found, kTimeStep);
  }
  return monitor;
}

void expectFound(const RigCorrection& rig, double offset) {
  const ColumnMonitor monitor = driven(rig, offset, 150);
  EXPECT_LT(monitor.deviation().maxCoeff(), 3e-5);
  EXPECT_LT(std::abs(monitor.estimate()[0] - rig.yaw), monitor.deviation()[0]) << offset;
  EXPECT_LT(std::abs(monitor.estimate()[1] - rig.bend), monitor.deviation()[1]) << offset;
}

TEST(ColumnMonitor, FindsAnInjectedYawFromTheBundles) {
  expectFound({.yaw = 5e-4, .bend = 0.0}, 0.0);
  expectFound({.yaw = -5e-4, .bend = 0.0}, 0.02);
}

TEST(ColumnMonitor, FindsAnInjectedBendFromTheBundles) {
  expectFound({.yaw = 0.0, .bend = 1e-3}, 0.0);
}

TEST(ColumnMonitor, FindsNothingWrongWithAGoodRig) {
  expectFound({}, 0.0);
  expectFound({}, 0.02);
}

}  // namespace
}  // namespace cartvo
