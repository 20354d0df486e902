// Tests of the filter for the delay of the right camera.
#include "vo_core/self_calibration/delay_filter.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/self_calibration/pitch_roll_filter.hpp"

namespace cartvo::vo {
namespace {

constexpr double kTimeStep = 0.055;  // s
constexpr int kMinute = 1091;        // pairs
constexpr int kDifferentPairs = 40;  // measured, then repeated

/// What the calibration leaves of the right camera's lens and place.
struct Remainder {
  double row_scale = 0.0, radial = 0.0, decentring = 0.0;
  double height = 0.0;  ///< m
};

/// Landmarks on a road 1.2 m below a camera that drives straight ahead, and on walls 4 m beside it, seen by a
/// right camera that is exposed `delay` s late.
BundleProblem street(double speed, double delay, const Remainder& remainder, std::uint64_t seed) {
  test::Noise random(seed);
  BundleProblem problem;
  problem.camera = test::kRigCamera;
  const auto pose_at = [&](double time) {
    return motionFromVector(test::vector6(0.0, 0.0, speed * time, 0.0, 0.0, 0.0));
  };
  problem.poses.push_back({0.0, 0.0, pose_at(0.0)});
  problem.poses.push_back({kTimeStep, 0.0, pose_at(kTimeStep)});
  const Eigen::Isometry3d right_inverse = test::rightOf(pose_at(kTimeStep + delay)).inverse();
  const double f = problem.camera.focal_length;
  while (problem.landmarks.size() < 400) {
    const Eigen::Vector2d pixel(problem.camera.width * random.uniform(),
                                problem.camera.height * random.uniform());
    BundleLandmark landmark;
    landmark.bearing = bearingOf(problem.camera, pixel);
    const double road = landmark.bearing.y() / 1.2, wall = std::abs(landmark.bearing.x()) / 4.0;
    landmark.inverse_depth = std::max(road, wall);
    if (landmark.inverse_depth < 0.02) continue;
    const Eigen::Vector3d world = landmark.bearing / landmark.inverse_depth;  // the anchor is the origin
    const Eigen::Vector3d left = pose_at(kTimeStep).inverse() * world, right = right_inverse * world;
    if (left.z() < 0.5 || right.z() < 0.5) continue;
    BundleObservation anchor, last;
    anchor.left = pixel;
    last.pose = 1;
    last.stereo = true;
    last.left = project(problem.camera, left);
    last.right = project(problem.camera, right);
    if (!test::inView(last.left)) continue;
    const double x = right.x() / right.z(), y = right.y() / right.z();
    const auto& [row_scale, radial, decentring, height] = remainder;
    last.right.y() -= f * (row_scale * y + radial * y * (x * x + y * y) + decentring * (x * x + 3.0 * y * y) +
                           height / right.z());
    last.right.y() += 0.1 * random.gaussian();
    landmark.observations.push_back(anchor);
    landmark.observations.push_back(last);
    problem.landmarks.push_back(landmark);
  }
  return problem;
}

struct Filters {
  DelayFilter delay;
  PitchRollFilter rows;  ///< estimates a delay without lens and baseline
};

/// A minute at a speed (m/s) that swings between half of `speed` and `speed`.
Filters drive(double speed, double delay, const Remainder& remainder) {
  std::vector<RowMeasurement> measured;
  for (int i = 0; i < kDifferentPairs; ++i) {
    const double now = speed * (0.75 + 0.25 * std::sin(2.0 * std::numbers::pi * i / kDifferentPairs));
    measured.push_back(measureRows(street(now, delay, remainder, 1 + i)));
  }
  Filters filters;
  for (int i = 0; i < kMinute; ++i) {
    const RowMeasurement& measurement = measured[i % kDifferentPairs];
    filters.delay.update(measurement, {}, kTimeStep);
    filters.rows.update(measurement, {}, kTimeStep);
  }
  return filters;
}

TEST(DelayFilter, FindsTheDelayOfASynchronousAndOfALateCamera) {
  for (const double truth : {0.0, 3e-3, -3e-3}) {
    const EstimateWithStddev found = drive(6.0, truth, {}).delay.delay();
    EXPECT_NEAR(found.value, truth, 0.2e-3);
    EXPECT_LT(found.stddev, 1e-3);
  }
}

/// How far (s) the delay that is estimated without lens and baseline is off.
double errorWithoutThem(const Filters& filters, double truth) {
  return std::abs(filters.rows.estimate()[RowErrors::kDelay] - truth);
}

TEST(DelayFilter, TellsTheLensFromADelay) {
  for (const Remainder& remainder : {Remainder{.row_scale = -8e-4}, Remainder{.radial = 2.7e-3}})
    for (const double truth : {0.0, 3e-3}) {
      const Filters filters = drive(6.0, truth, remainder);
      EXPECT_NEAR(filters.delay.delay().value, truth, 0.1e-3);
      EXPECT_GT(errorWithoutThem(filters, truth), 0.6e-3);
      const RowPatterns::Vector& found = filters.delay.estimate();
      EXPECT_NEAR(found[RowPatterns::kRowScale], remainder.row_scale, 3e-4);
      EXPECT_NEAR(found[RowPatterns::kRadial], remainder.radial, 8e-4);
    }
}

TEST(DelayFilter, TellsAllOfACalibrationsRemainderFromADelay) {
  const Remainder remainder{.row_scale = -8e-4, .radial = -1e-3, .decentring = 4e-4, .height = -4e-4};
  const Filters filters = drive(6.0, 0.0, remainder);
  const EstimateWithStddev found = filters.delay.delay();
  EXPECT_NEAR(found.value, 0.0, 0.1e-3);
  EXPECT_GT(errorWithoutThem(filters, 0.0), 0.9e-3);
  EXPECT_NEAR(filters.delay.estimate()[RowPatterns::kDecentring], remainder.decentring, 2e-4);
}

TEST(DelayFilter, IsNotCertainWhenTheCameraHardlyMoves) {
  EXPECT_GT(drive(0.05, 0.0, {}).delay.delay().stddev, 3e-3);
}

TEST(DelayFilter, TakesTheAppliedCorrectionIntoAccount) {
  // Rows corrected by a wrong pitch and roll show their opposites.
  BundleProblem problem = street(6.0, 0.0, {}, 1);
  const RigCorrection applied{.pitch = 2e-3, .roll = -2e-3};
  for (BundleLandmark& landmark : problem.landmarks)
    landmark.observations.back().right =
        correctedRight(problem.camera, applied, landmark.observations.back().right);
  const RowMeasurement measurement = measureRows(problem);
  DelayFilter filter;
  for (int i = 0; i < kMinute; ++i)
    filter.update(measurement, applied, kTimeStep);
  EXPECT_NEAR(filter.estimate()[RowPatterns::kPitch], 0.0, 3e-4);
  EXPECT_NEAR(filter.estimate()[RowPatterns::kRoll], 0.0, 3e-4);
}

TEST(DelayFilter, FollowsClocksThatBeginToDiffer) {
  const RowMeasurement before = measureRows(street(6.0, 0.0, {}, 1));
  const RowMeasurement after = measureRows(street(6.0, 3e-3, {}, 1));
  DelayFilter filter;
  for (int i = 0; i < 5 * kMinute; ++i)
    filter.update(before, {}, kTimeStep);
  const double at_first = filter.delay().value;
  for (int i = 0; i < kMinute; ++i)
    filter.update(after, {}, kTimeStep);
  EXPECT_NEAR(filter.delay().value - at_first, 3e-3, 1e-3);
}

TEST(DelayFilter, IgnoresNan) {
  Filters filters = drive(6.0, 1e-3, {});
  const double before = filters.delay.delay().value;
  RowMeasurement measurement;
  measurement.equations.information.setIdentity();
  measurement.equations.gradient.setConstant(std::numeric_limits<double>::quiet_NaN());
  filters.delay.update(measurement, {}, kTimeStep);
  EXPECT_EQ(filters.delay.delay().value, before);
}

}  // namespace
}  // namespace cartvo::vo
