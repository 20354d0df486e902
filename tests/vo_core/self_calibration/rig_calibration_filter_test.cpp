// Tests of the information filter for the rig's calibration errors.
#include "vo_core/self_calibration/rig_calibration_filter.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "common/units.hpp"
#include "support/vo_core/landmark_scene.hpp"

namespace cartvo::vo {
namespace {

constexpr double kTimeStep = 0.055;  // s
constexpr int kMinute = 1091;        // pairs
constexpr int kDifferentPairs = 40;  // rendered, then repeated

/// Errors of the right camera's lens and place that remain after the calibration.
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

/// Feeds a filter with pairs, each corrected by the filter's correction.
class Drive {
 public:
  /// A minute at a speed (m/s) that swings between half of `speed` and `speed`.
  Drive(double speed, double delay, const Remainder& remainder) {
    for (int i = 0; i < kDifferentPairs; ++i) {
      const double now = speed * (0.75 + 0.25 * std::sin(2.0 * std::numbers::pi * i / kDifferentPairs));
      street_.push_back(street(now, delay, remainder, 1 + i));
    }
  }

  void updateRows(RigCalibrationFilter& rig, const RigCorrection& truth, int pairs) {
    RowRegression regression({});
    for (int i = 0; i < pairs; ++i) {
      BundleProblem problem = street_[i % kDifferentPairs];
      const RigCorrection applied = rig.correction();
      for (BundleLandmark& landmark : problem.landmarks) {
        Eigen::Vector2d& right = landmark.observations.back().right;
        right = correctedRight(problem.camera, applied, test::miscalibratedPixel(truth, right));
      }
      rig.predict(kTimeStep);
      rig.updateRows(regression.measure(problem, rig.expectedRows(applied)));
    }
  }

 private:
  std::vector<BundleProblem> street_;
};

RigCalibrationError errorAfter(double speed, double delay, const Remainder& remainder) {
  RigCalibrationFilter rig;
  Drive(speed, delay, remainder).updateRows(rig, {}, kMinute);
  return rig.error();
}

TEST(RigCalibrationFilter, KnowsNothingInitially) {
  const RigCalibrationFilter rig;
  const RigCalibrationError error = rig.error();
  EXPECT_EQ(rig.correction().pitch, 0.0);
  EXPECT_EQ(rig.correction().yaw, 0.0);
  EXPECT_GT(error.pitch.stddev, 1e-3);
  EXPECT_EQ(error.observability.pitch, 0.0);
}

TEST(RigCalibrationFilter, FindsPitchAndRollByRows) {
  const RigCorrection truth{.pitch = 0.3 * kRadiansPerDegree, .roll = -0.3 * kRadiansPerDegree};
  RigCalibrationFilter rig;
  Drive(6.0, 0.0, {}).updateRows(rig, truth, 200);
  EXPECT_NEAR(rig.correction().pitch, truth.pitch, 0.02 * kRadiansPerDegree);
  EXPECT_NEAR(rig.correction().roll, truth.roll, 0.02 * kRadiansPerDegree);
}

TEST(RigCalibrationFilter, FindsABumpWithinTwoSeconds) {
  constexpr double kAngle = 0.3 * kRadiansPerDegree;
  for (const RigCorrection& bumped : {RigCorrection{.pitch = kAngle}, RigCorrection{.roll = -kAngle}}) {
    RigCalibrationFilter rig;
    Drive drive(6.0, 0.0, {});
    drive.updateRows(rig, {}, kMinute);
    drive.updateRows(rig, bumped, 36);
    EXPECT_NEAR(rig.error().pitch.value, bumped.pitch, 0.03 * kRadiansPerDegree);
    EXPECT_NEAR(rig.error().roll.value, bumped.roll, 0.03 * kRadiansPerDegree);
  }
}

TEST(RigCalibrationFilter, TakesAConstantCrossTermForTheLens) {
  RigCalibrationFilter rig;
  Drive(6.0, 0.0, {}).updateRows(rig, {.yaw = 5e-3}, kMinute);
  EXPECT_LT(std::abs(rig.error().yaw.value), 0.2 * 5e-3);
}

TEST(RigCalibrationFilter, FindsTheDelayOfASynchronousAndOfALateCamera) {
  for (const double truth : {0.0, 3e-3, -3e-3}) {
    const RigCalibrationError found = errorAfter(6.0, truth, {});
    EXPECT_NEAR(found.delay.value, truth, 0.2e-3);
    EXPECT_LT(found.delay.stddev, 1e-3);
    EXPECT_GT(found.observability.delay, 0.9);
  }
}

TEST(RigCalibrationFilter, TellsTheLensFromADelay) {
  for (const Remainder& remainder :
       {Remainder{.row_scale = -8e-4}, Remainder{.radial = 2.7e-3},
        Remainder{.row_scale = -8e-4, .radial = -1e-3, .decentring = 4e-4, .height = -4e-4}})
    for (const double truth : {0.0, 3e-3})
      EXPECT_NEAR(errorAfter(6.0, truth, remainder).delay.value, truth, 0.15e-3);
}

TEST(RigCalibrationFilter, ObservesNoDelayWhenTheCameraHardlyMoves) {
  const RigCalibrationError error = errorAfter(0.05, 0.0, {});
  EXPECT_GT(error.delay.stddev, 3e-3);
}

TEST(RigCalibrationFilter, FollowsClocksThatBeginToDiffer) {
  RigCalibrationFilter rig;
  Drive(6.0, 0.0, {}).updateRows(rig, {}, 2 * kMinute);
  Drive(6.0, 3e-3, {}).updateRows(rig, {}, kMinute);
  EXPECT_NEAR(rig.error().delay.value, 3e-3, 1e-3);
}

TEST(RigCalibrationFilter, ExpectsAReinitialisedPitch) {
  RigCalibrationFilter rig;
  rig.reinitialisePitch({2e-3, 1e-3});
  const double yaw_stddev = rig.error().yaw.stddev;
  rig.reinitialisePitch({-5e-3, 1e-3});
  EXPECT_GT(rig.error().yaw.stddev, yaw_stddev);
  EXPECT_NEAR(rig.expected().pitch, -5e-3, 1e-6);
  EXPECT_NEAR(rig.error().pitch.stddev, 1e-3, 1e-6);
  EXPECT_EQ(rig.error().delay.value, 0.0);
}

/// A window long enough for disparities.
BundleProblem window() {
  BundleProblem problem;
  problem.poses.resize(2);
  problem.poses.back().time = kTimeStep;
  problem.poses.back().T_world_camera.translation().z() = 1.0;
  return problem;
}

/// Updates with the disparities of `pairs` pairs, which measure yaw and p2 with these standard deviations.
void updateDisparities(RigCalibrationFilter& rig, const RigCorrection::Vector& truth, int pairs,
                       const RigCorrection::Vector& stddev = {1e-4, 2e-4}) {
  const BundleProblem problem = window();
  BundleResult result;
  result.rig_information = stddev.cwiseAbs2().cwiseInverse().asDiagonal();
  for (int i = 0; i < pairs; ++i) {
    const RigCorrection applied = rig.correction();
    result.rig_gradient = result.rig_information * (truth - RigCorrection::Vector(applied.yaw, applied.p2));
    rig.predict(kTimeStep);
    rig.updateDisparities(problem, result, applied);
  }
}

TEST(RigCalibrationFilter, FindsYawAndP2ByDisparities) {
  for (const double sign : {-1.0, 1.0}) {
    RigCalibrationFilter rig;
    updateDisparities(rig, {sign * 4e-4, -sign * 7e-4}, 1000);
    EXPECT_NEAR(rig.correction().yaw, sign * 4e-4, 1e-5);
    EXPECT_NEAR(rig.correction().p2, -sign * 7e-4, 1e-5);
  }
}

TEST(RigCalibrationFilter, CountsPairsAsCorrelated) {
  RigCalibrationFilter rig;
  updateDisparities(rig, {0.0, 0.0}, 100, {1e-2, 1e-2});
  EXPECT_GT(rig.error().yaw.stddev, 2.0 * 1e-2 / std::sqrt(100.0));
}

TEST(RigCalibrationFilter, CorrectsNothingThatIsNotSignificant) {
  RigCalibrationFilter rig;
  updateDisparities(rig, {1e-4, 0.0}, 2, {1e-3, 1e-3});
  EXPECT_NE(rig.error().yaw.value, 0.0);
  EXPECT_EQ(rig.correction().yaw, 0.0);
}

TEST(RigCalibrationFilter, LimitsTheCorrection) {
  for (const double sign : {-1.0, 1.0}) {
    RigCalibrationFilter rig;
    updateDisparities(rig, {sign * 0.02, sign * 0.02}, 3000);
    EXPECT_NEAR(rig.error().yaw.value, sign * 0.02, 1e-3);  // the estimate is not limited
    EXPECT_DOUBLE_EQ(rig.correction().yaw, sign * 1e-2);
    EXPECT_DOUBLE_EQ(rig.correction().p2, sign * 3e-3);
    EXPECT_GT(rig.error().yaw.stddev, 0.01);
  }
}

TEST(RigCalibrationFilter, FindsABumpByDisparitiesAfterALongDrive) {
  RigCalibrationFilter rig;
  updateDisparities(rig, {0.0, 0.0}, 20'000);
  updateDisparities(rig, {5e-3, 0.0}, 36);
  EXPECT_NEAR(rig.error().yaw.value, 5e-3, 5e-4);
}

TEST(RigCalibrationFilter, DoesNotTakeASingleFalsePairForABump) {
  RigCalibrationFilter rig;
  updateDisparities(rig, {0.0, 0.0}, 1000);
  updateDisparities(rig, {5e-3, 0.0}, 1);
  EXPECT_LT(std::abs(rig.error().yaw.value), 1e-4);
}

TEST(RigCalibrationFilter, IgnoresNan) {
  RigCalibrationFilter rig;
  updateDisparities(rig, {4e-4, 0.0}, 10);
  const RigCalibrationError before = rig.error();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  updateDisparities(rig, {nan, 0.0}, 1);
  updateDisparities(rig, {0.0, 0.0}, 1, {nan, 1.0});
  RowMeasurement rows;
  rows.information.setIdentity();
  rows.mean_products.setIdentity();
  rows.precision = 1.0;
  rows.gradient.setConstant(nan);
  rig.updateRows(rows);
  EXPECT_EQ(rig.error().yaw.value, before.yaw.value);
  EXPECT_EQ(rig.error().pitch.value, before.pitch.value);
}

/// Filter after a drive with a wrongly calibrated rig, whose pairs are adjusted with the correction so far.
void expectFoundByAdjustments(const RigCorrection& truth, double offset) {
  RigCalibrationFilter rig;
  for (int i = 0; i < 150; ++i) {
    BundleProblem problem = test::simulateProblem({.offset = offset, .noise = 1.0, .rig = truth}, 1 + i);
    const RigCorrection applied = rig.correction();
    for (BundleLandmark& landmark : problem.landmarks)
      for (BundleObservation& observation : landmark.observations)
        observation.right = correctedRight(problem.camera, applied, observation.right);
    const BundleResult result = test::adjustBundle(problem, BundleSettings{});
    ASSERT_TRUE(result.converged);
    rig.predict(kTimeStep);
    rig.updateDisparities(problem, result, applied);
    // Without rows a yaw of a camera that turns cannot be told from a delay.
    rig.updateRows(RowRegression({}).measure(problem, rig.expectedRows(applied)));
  }
  EXPECT_NEAR(rig.error().yaw.value, truth.yaw, 1e-4) << offset;
  EXPECT_NEAR(rig.correction().p2, truth.p2, 1e-4) << offset;
}

TEST(RigCalibrationFilter, FindsYawAndP2FromBundleAdjustments) {
  expectFoundByAdjustments({}, 0.02);
  expectFoundByAdjustments({.yaw = 5e-4}, 0.0);
  expectFoundByAdjustments({.yaw = -5e-4}, 0.02);
  expectFoundByAdjustments({.p2 = 1e-3}, 0.0);
}

}  // namespace
}  // namespace cartvo::vo
