// Tests of the row errors measured from one pair.
#include "vo_core/self_calibration/row_measurement.hpp"

#include <Eigen/LU>
#include <cmath>

#include <gtest/gtest.h>

#include "common/units.hpp"
#include "support/vo_core/landmark_scene.hpp"

namespace cartvo::vo {
namespace {

constexpr int kLandmarks = 400;

constexpr int kErrors = 4;  // pitch, roll, cross term, delay: those of a camera whose lens is known
using Errors = Eigen::Matrix<double, kErrors, 1>;

RowMeasurement measureRows(const BundleProblem& problem,
                           const RowPatterns::Vector& expected = RowPatterns::Vector::Zero()) {
  return RowRegression({}).measure(problem, expected);
}

/// Errors (rad and s) of a camera whose lens is known, and whose errors are expected as they are found.
Errors errorsOf(const BundleProblem& problem) {
  RowPatterns::Vector expected = RowPatterns::Vector::Zero();
  for (int round = 0; round < 4; ++round) {
    const RowMeasurement rows = measureRows(problem, expected);
    expected.head<kErrors>() +=
        rows.information.topLeftCorner<kErrors, kErrors>().inverse() * rows.gradient.head<kErrors>();
  }
  return expected.head<kErrors>();
}

/// rad and s.
void expectErrors(const Errors& found, const Errors& truth, double angle, double delay) {
  for (const int index : {RowPatterns::kPitch, RowPatterns::kRoll, RowPatterns::kCrossTerm})
    EXPECT_NEAR(found[index], truth[index], angle) << index;
  EXPECT_NEAR(found[RowPatterns::kDelay], truth[RowPatterns::kDelay], delay);
}

TEST(RowMeasurement, FindsTheRotationOfTheRightCamera) {
  const RigCorrection rig{.yaw = 1e-3, .pitch = 0.3 * kRadiansPerDegree, .roll = -0.3 * kRadiansPerDegree};
  for (const double offset : {0.0, 0.02, -0.02}) {
    const BundleProblem problem =
        test::simulateProblem({.landmarks = kLandmarks, .offset = offset, .rig = rig}, 1);
    expectErrors(errorsOf(problem), {rig.pitch, rig.roll, rig.yaw, 0.0}, 5e-5, 1e-4);
  }
}

TEST(RowMeasurement, FindsTheDelayOfTheRightCamera) {
  for (const double offset : {0.0, 0.02, -0.02})
    for (const double delay : {-3e-3, 3e-3}) {
      const BundleProblem problem =
          test::simulateProblem({.landmarks = kLandmarks, .offset = offset, .delay = delay}, 1);
      expectErrors(errorsOf(problem), {0.0, 0.0, 0.0, delay}, 1e-4, 1e-4);
    }
}

TEST(RowMeasurement, IsRobustAgainstFalseMatches) {
  BundleProblem problem = test::simulateProblem(
      {.landmarks = kLandmarks, .noise = 1.0, .rig = {.roll = 0.2 * kRadiansPerDegree}}, 1);
  for (std::size_t i = 0; i < problem.landmarks.size(); i += 5)
    problem.landmarks[i].observations.back().right.y() += 4.0;
  EXPECT_NEAR(errorsOf(problem)[RowPatterns::kRoll], 0.2 * kRadiansPerDegree, 0.02 * kRadiansPerDegree);
}

TEST(RowMeasurement, ErrorsAgreeWithTheInformation) {
  constexpr int kTrials = 60;
  double sum = 0.0;
  for (int i = 0; i < kTrials; ++i) {
    const RowMeasurement rows =
        measureRows(test::simulateProblem({.landmarks = kLandmarks, .noise = 1.0}, 1 + i));
    const Errors gradient = rows.gradient.head<kErrors>();
    const auto information = rows.information.topLeftCorner<kErrors, kErrors>();
    sum += gradient.dot(information.inverse() * gradient) / kErrors / kTrials;
  }
  // Robust weights make the information slightly conservative; the noise is estimated from the rows.
  EXPECT_GT(sum, 0.5);
  EXPECT_LT(sum, 2.0);
}

TEST(RowMeasurement, AnglesAreLessCertainWithALargerTimeOffset) {
  const auto information_at = [](double offset) {
    return measureRows(test::simulateProblem({.landmarks = kLandmarks, .offset = offset, .noise = 1.0}, 1))
        .information;
  };
  EXPECT_LT(information_at(0.025)(0, 0), 0.1 * information_at(0.0)(0, 0));
}

TEST(RowMeasurement, HasNoInformationFromFewMatches) {
  EXPECT_EQ(measureRows(test::simulateProblem({.landmarks = 20}, 1)).information,
            RowPatterns::Matrix::Zero());
}

}  // namespace
}  // namespace cartvo::vo
