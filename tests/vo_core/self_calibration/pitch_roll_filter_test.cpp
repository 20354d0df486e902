// Tests of the filter for pitch, roll and delay and of its correction.
#include "vo_core/self_calibration/pitch_roll_filter.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/units.hpp"

namespace cartvo::vo {
namespace {

using Vector = RowErrors::Vector;

constexpr double kTimeStep = 0.055;  // s
constexpr int kMinute = 1091;        // pairs

/// Updates a filter with `pairs` pairs, each of which measures the errors precisely.
void measure(PitchRollFilter& filter, const Vector& truth, int pairs) {
  RowMeasurement measurement;
  measurement.information = Vector(1e-5, 1e-5, 1e-4, 3e-5).cwiseAbs2().cwiseInverse().asDiagonal();
  measurement.mean_products = Vector(480.0, 200.0, 50.0, 70.0).cwiseAbs2().asDiagonal();
  for (int i = 0; i < pairs; ++i) {
    const RigCorrection applied = filter.correction();
    measurement.errors = truth - Vector(applied.pitch, applied.roll, 0.0, 0.0);
    filter.update(measurement, applied, kTimeStep);
  }
}

PitchRollFilter filterAfter(const Vector& truth, int pairs) {
  PitchRollFilter filter;
  measure(filter, truth, pairs);
  return filter;
}

TEST(PitchRollFilter, CorrectsNothingInitially) {
  const PitchRollFilter filter;
  EXPECT_EQ(filter.estimate(), Vector::Zero());
  EXPECT_EQ(filter.correction().pitch, 0.0);
  EXPECT_GT(filter.stddev().minCoeff(), 1e-3);
}

TEST(PitchRollFilter, ConvergesToTheTruth) {
  const Vector truth(0.3 * kRadiansPerDegree, -0.3 * kRadiansPerDegree, 2e-3, 3e-3);
  const PitchRollFilter filter = filterAfter(truth, kMinute);
  EXPECT_LT((filter.estimate() - truth).norm(), 1e-5);
  EXPECT_NEAR(filter.correction().pitch, truth[0], 0.01 * kRadiansPerDegree);
  EXPECT_NEAR(filter.correction().roll, truth[1], 0.01 * kRadiansPerDegree);
}

TEST(PitchRollFilter, StddevIncludesUnmodelledRows) {
  const Vector stddev = filterAfter(Vector::Zero(), kMinute).stddev();
  EXPECT_GT(stddev[RowErrors::kPitch], 0.02 / 480.0);
  EXPECT_GT(stddev[RowErrors::kDelay], 0.02 / 70.0);
}

TEST(PitchRollFilter, CorrectsNothingWithinTheDeadZone) {
  const RigCorrection correction = filterAfter(Vector(4e-4, -4e-4, 5e-3, 5e-4), kMinute).correction();
  EXPECT_EQ(correction.pitch, 0.0);
  EXPECT_EQ(correction.roll, 0.0);
}

TEST(PitchRollFilter, LimitsTheCorrection) {
  const PitchRollFilter filter = filterAfter(Vector(0.03, -0.03, 0.0, 0.0), kMinute);
  EXPECT_EQ(filter.correction().pitch, 1e-2);
  EXPECT_EQ(filter.correction().roll, -1e-2);
}

TEST(PitchRollFilter, FindsABumpWithinAMinuteAfterALongDrive) {
  PitchRollFilter filter = filterAfter(Vector::Zero(), 20 * kMinute);
  const Vector bumped(0.3 * kRadiansPerDegree, 0.0, 0.0, 3e-3);
  measure(filter, bumped, kMinute);
  EXPECT_NEAR(filter.estimate()[RowErrors::kPitch], bumped[0], 0.03 * kRadiansPerDegree);
  EXPECT_NEAR(filter.estimate()[RowErrors::kDelay], bumped[3], 1e-3);
}

TEST(PitchRollFilter, ReportsAStepOfTheCrossTermAsYaw) {
  PitchRollFilter filter = filterAfter(Vector(0.0, 0.0, -8e-3, 0.0), kMinute);
  EXPECT_EQ(filter.takeYawStep(), 0.0) << "a constant cross term is the lens's";
  double total = 0.0;
  for (int i = 0; i < kMinute; ++i) {
    measure(filter, Vector(0.0, 0.0, -3e-3, 0.0), 1);
    total += filter.takeYawStep();
  }
  EXPECT_NEAR(total, 5e-3, 1.1e-3);
}

TEST(PitchRollFilter, DoesNotReportADriftOfTheCrossTerm) {
  PitchRollFilter filter;
  for (int i = 0; i < 20 * kMinute; ++i) {
    measure(filter, Vector(0.0, 0.0, 3e-7 * i, 0.0), 1);
    EXPECT_EQ(filter.takeYawStep(), 0.0);
  }
}

TEST(PitchRollFilter, ExpectsAReinitialisedPitch) {
  PitchRollFilter filter;
  filter.reinitialisePitch(-5e-3);
  EXPECT_NEAR(filter.expected().pitch, -5e-3, 1e-3);
  EXPECT_LT(std::abs(filter.correction().pitch), 4e-3) << "a coarse pitch is not corrected in full";
}

TEST(PitchRollFilter, IgnoresNan) {
  PitchRollFilter filter = filterAfter(Vector(1e-3, 0.0, 0.0, 0.0), 10);
  const Vector estimate = filter.estimate();
  RowMeasurement measurement;
  measurement.information.setIdentity();
  measurement.errors.setConstant(std::numeric_limits<double>::quiet_NaN());
  filter.update(measurement, {}, kTimeStep);
  EXPECT_EQ(filter.estimate(), estimate);
}

}  // namespace
}  // namespace cartvo::vo
