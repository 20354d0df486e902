// What rows tell of the rig over time, and how much of it is used.
#include "vo_core/row_monitor.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

using Vector = RowErrors::Vector;

constexpr double kTimeStep = 0.055;  // s
constexpr double kDegree = M_PI / 180.0;
constexpr int kMinute = 1091;  // pairs

/// Tells a monitor of so many pairs more, each of which knows the errors well.
void tell(RowMonitor& monitor, const Vector& truth, int pairs) {
  RowEvidence evidence;
  evidence.information = Vector(1e-5, 1e-5, 1e-4, 3e-5).cwiseAbs2().cwiseInverse().asDiagonal();
  evidence.leverage = Vector(480.0, 200.0, 50.0, 70.0).cwiseAbs2().asDiagonal();
  for (int i = 0; i < pairs; ++i) {
    const RigCorrection applied = monitor.correction();
    evidence.errors = truth - Vector(applied.pitch, applied.roll, 0.0, 0.0);
    monitor.add(evidence, applied, kTimeStep);
  }
}

RowMonitor told(const Vector& truth, int pairs) {
  RowMonitor monitor;
  tell(monitor, truth, pairs);
  return monitor;
}

TEST(RowMonitor, CorrectsNothingToBeginWith) {
  const RowMonitor monitor;
  EXPECT_EQ(monitor.estimate(), Vector::Zero());
  EXPECT_EQ(monitor.correction().pitch, 0.0);
  EXPECT_GT(monitor.deviation().minCoeff(), 1e-3);
}

TEST(RowMonitor, ConvergesToWhatThePairsTell) {
  const Vector truth(0.3 * kDegree, -0.3 * kDegree, 2e-3, 3e-3);
  const RowMonitor monitor = told(truth, kMinute);
  EXPECT_LT((monitor.estimate() - truth).norm(), 1e-5);
  EXPECT_NEAR(monitor.correction().pitch, truth[0], 0.01 * kDegree);
  EXPECT_NEAR(monitor.correction().roll, truth[1], 0.01 * kDegree);
}

TEST(RowMonitor, NeverClaimsToKnowMoreThanACalibrationLeavesOver) {
  const Vector deviation = told(Vector::Zero(), kMinute).deviation();
  EXPECT_GT(deviation[RowErrors::kPitch], 0.02 / 480.0);
  EXPECT_GT(deviation[RowErrors::kDelay], 0.02 / 70.0);
}

TEST(RowMonitor, CorrectsNothingThatAnyCalibrationLeavesOver) {
  const RigCorrection correction = told(Vector(4e-4, -4e-4, 5e-3, 5e-4), kMinute).correction();
  EXPECT_EQ(correction.pitch, 0.0);
  EXPECT_EQ(correction.roll, 0.0);
}

TEST(RowMonitor, CorrectsNoMoreThanARigMayHaveComeTo) {
  const RowMonitor monitor = told(Vector(0.03, -0.03, 0.0, 0.0), kMinute);
  EXPECT_EQ(monitor.correction().pitch, 1e-2);
  EXPECT_EQ(monitor.correction().roll, -1e-2);
}

TEST(RowMonitor, FindsABumpWithinAMinuteAfterALongDrive) {
  RowMonitor monitor = told(Vector::Zero(), 20 * kMinute);
  const Vector bumped(0.3 * kDegree, 0.0, 0.0, 3e-3);
  tell(monitor, bumped, kMinute);
  EXPECT_NEAR(monitor.estimate()[RowErrors::kPitch], bumped[0], 0.03 * kDegree);
  EXPECT_NEAR(monitor.estimate()[RowErrors::kDelay], bumped[3], 1e-3);
}

TEST(RowMonitor, AKeystoneThatChangesIsATurn) {
  RowMonitor monitor = told(Vector(0.0, 0.0, -8e-3, 0.0), kMinute);
  EXPECT_EQ(monitor.takeTurn(), 0.0) << "the lens's";
  double turned = 0.0;
  for (int i = 0; i < kMinute; ++i) {
    tell(monitor, Vector(0.0, 0.0, -3e-3, 0.0), 1);
    turned += monitor.takeTurn();
  }
  EXPECT_NEAR(turned, 5e-3, 1.1e-3);
}

TEST(RowMonitor, AKeystoneThatDriftsIsNoTurn) {
  RowMonitor monitor;
  for (int i = 0; i < 20 * kMinute; ++i) {
    tell(monitor, Vector(0.0, 0.0, 3e-7 * i, 0.0), 1);
    EXPECT_EQ(monitor.takeTurn(), 0.0);
  }
}

TEST(RowMonitor, LooksForMatchesWhereASuspicionPuts) {
  RowMonitor monitor;
  monitor.suspectPitch(-5e-3);
  EXPECT_NEAR(monitor.expected().pitch, -5e-3, 1e-3);
  EXPECT_LT(std::abs(monitor.correction().pitch), 4e-3) << "it is rough";
}

TEST(RowMonitor, WhatIsNotANumberLeavesItAsItWas) {
  RowMonitor monitor = told(Vector(1e-3, 0.0, 0.0, 0.0), 10);
  const Vector estimate = monitor.estimate();
  RowEvidence evidence;
  evidence.information.setIdentity();
  evidence.errors.setConstant(std::numeric_limits<double>::quiet_NaN());
  monitor.add(evidence, {}, kTimeStep);
  EXPECT_EQ(monitor.estimate(), estimate);
}

}  // namespace
}  // namespace cartvo
