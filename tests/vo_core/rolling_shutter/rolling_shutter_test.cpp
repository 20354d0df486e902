// Tests of the odometry with rolling shutters, on a drive through a rendered corridor.
#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{
    .focal_length = 240.0, .cx = 160.0, .cy = 120.0, .baseline = 0.115, .width = 320, .height = 240};
constexpr double kPeriod = 0.055, kReadout = 0.032;  // s
constexpr int kPairs = 32, kSettledPairs = 8;

/// A drive with turns, and the cameras' readout and time offset (s).
struct Drive {
  double readout = kReadout;
  double offset = 0.0;
  double shake = 0.0;            ///< rad, amplitude of a vibration in pitch
  double shake_frequency = 6.0;  ///< Hz
  double liveliness = 1.0;       ///< factor on the turns

  Eigen::Isometry3d pose(double time) const {
    Vector6d motion = Vector6d::Zero();
    motion[2] = 1.5 * time;
    motion[0] = 0.15 * std::sin(2.0 * time);
    motion[4] = 0.12 * liveliness * std::sin(3.0 * time);
    motion[3] = 0.01 * std::sin(7.0 * time) + shake * std::sin(2.0 * M_PI * shake_frequency * time);
    return motionFromVector(motion);
  }

  StereoImages images(const test::CorridorWorld& world, double time) const {
    const auto at_row = [&](double exposure, int row) {
      return pose(exposure + readout * ((row + 0.5) / kCamera.height - 0.5));
    };
    StereoImages images;
    images.left = world.rollingView(kCamera, [&](int row) { return at_row(time, row); });
    images.right = world.rollingView(kCamera, [&](int row) -> Eigen::Isometry3d {
      return at_row(time + offset, row) * Eigen::Translation3d(kCamera.baseline, 0.0, 0.0);
    });
    images.left_exposure_ns = 1'000'000'000 + std::llround(1e9 * time);
    images.right_exposure_ns = images.left_exposure_ns + std::llround(1e9 * offset);
    return images;
  }
};

/// RMS errors of the motions (m, rad) and of the rates (rad/s), squared errors of the motions relative to
/// their covariances (1 on average if these are true), and what is estimated of the readouts.
struct Errors {
  double translation = 0.0, rotation = 0.0, rates = 0.0;
  double consistency = 0.0;
  double largest_velocity_error = 0.0;  ///< m/s, mean over a pair, of all valid pairs from the start on
  int valid = 0;
  std::optional<ReadoutEstimates> readouts;
};

Errors errorsOf(const Drive& drive, const StereoShutters& shutters) {
  const test::CorridorWorld world(3);
  OdometrySettings settings;
  settings.features = 500;
  StereoOdometry odometry(kCamera, settings, shutters);
  NullStageObserver observer;
  Errors errors;
  for (int i = 0; i < kPairs; ++i) {
    const double time = i * kPeriod;
    const OdometryEstimate estimate = odometry.process(drive.images(world, time), observer);
    errors.readouts = estimate.readouts;
    if (!estimate.valid) continue;
    const Eigen::Isometry3d now = drive.pose(time);
    const Vector6d error =
        vectorFromMotion(estimate.T_previous_current.inverse() * drive.pose(time - kPeriod).inverse() * now);
    errors.largest_velocity_error = std::max(errors.largest_velocity_error, error.head<3>().norm() / kPeriod);
    if (i < kSettledPairs) continue;
    ++errors.valid;
    errors.translation += error.head<3>().squaredNorm();
    errors.rotation += error.tail<3>().squaredNorm();
    errors.consistency += error.dot(estimate.motion_covariance.ldlt().solve(error)) / 6.0;
    if (!estimate.twist) continue;
    constexpr double kStep = 1e-4;  // s
    const Vector6d truth =
        vectorFromMotion(drive.pose(time - kStep).inverse() * drive.pose(time + kStep)) / (2.0 * kStep);
    errors.rates += (estimate.twist->value - truth).tail<3>().squaredNorm();
  }
  for (double* sum : {&errors.translation, &errors.rotation, &errors.rates})
    *sum = std::sqrt(*sum / errors.valid);
  errors.consistency /= errors.valid;
  return errors;
}

StereoShutters shuttersOf(double readout, double stddev) {
  return {{readout, stddev, {}}, {readout, stddev, {}}};
}

TEST(RollingShutter, IsAsAccurateAsAGlobalOne) {
  const Errors global = errorsOf({.readout = 0.0}, {});
  for (const double readout : {kReadout, -kReadout}) {
    const Errors rolling = errorsOf({.readout = readout}, shuttersOf(readout, 0.0));
    EXPECT_EQ(rolling.valid, kPairs - kSettledPairs);
    // A shutter that is ignored errs 8 and 12 times as much. Either error of one drive scatters by chance.
    EXPECT_LT(rolling.translation, 2.0 * global.translation);
    EXPECT_LT(rolling.rotation, 2.0 * global.rotation);
    EXPECT_LT(rolling.rates, 0.02);
    EXPECT_LT(rolling.consistency, 1.5);
  }
}

TEST(RollingShutter, OfUnsynchronisedCamerasIsModelled) {
  const Errors ignored = errorsOf({.offset = 0.02}, {});
  const Errors rolling = errorsOf({.offset = 0.02}, shuttersOf(kReadout, 0.0));
  EXPECT_LT(rolling.translation, 0.4 * ignored.translation);
  EXPECT_LT(rolling.rotation, 0.3 * ignored.rotation);
}

constexpr double kUnknownStddev = 0.0128;  // s, of a readout that is not stated

TEST(RollingShutter, WhoseReadoutIsUnknownIsEstimated) {
  const Errors errors = errorsOf({}, shuttersOf(0.028, kUnknownStddev));
  ASSERT_TRUE(errors.readouts);
  for (const EstimateWithStddev& readout : {errors.readouts->left, errors.readouts->right}) {
    EXPECT_LT(readout.stddev, 0.2 * kUnknownStddev);
    EXPECT_NEAR(readout.value, kReadout, 3.0 * readout.stddev);
  }
}

TEST(RollingShutter, WhoseStatedReadoutIsWrongIsCorrected) {
  constexpr double kStated = 0.028;
  const Errors errors = errorsOf({.liveliness = 3.0}, shuttersOf(kStated, 0.0));
  const Errors right = errorsOf({.liveliness = 3.0}, shuttersOf(kReadout, 0.0));
  ASSERT_TRUE(errors.readouts);
  for (const EstimateWithStddev& readout : {errors.readouts->left, errors.readouts->right}) {
    EXPECT_GT(readout.value, kStated + 2.0 * readout.stddev);
    EXPECT_NEAR(readout.value, kReadout, 3.0 * readout.stddev);
  }
  EXPECT_LT(errors.rotation, 1.5 * right.rotation);
}

// A readout that was estimated with the motions that it timed made velocities of 100 m/s and more.
TEST(RollingShutter, WhoseReadoutIsUnknownDoesNoHarmOnALivelyDrive) {
  for (const double readout : {0.030, 0.0}) {
    const Errors unknown =
        errorsOf({.readout = readout, .liveliness = 3.0}, shuttersOf(kReadout, kUnknownStddev));
    EXPECT_EQ(unknown.valid, kPairs - kSettledPairs) << readout;
    EXPECT_LT(unknown.largest_velocity_error, 0.3) << readout;
    ASSERT_TRUE(unknown.readouts);
    EXPECT_NEAR(unknown.readouts->left.value, readout, 0.004);
    EXPECT_NEAR(unknown.readouts->right.value, readout, 0.004);
  }
}

TEST(RollingShutter, ShowsAShakenMountByItsRows) {
  const Drive shaken{.shake = 0.004};
  const Errors ignored = errorsOf(shaken, {});
  const Errors rolling = errorsOf(shaken, shuttersOf(kReadout, 0.0));
  EXPECT_LT(rolling.translation, 0.3 * ignored.translation);
  EXPECT_LT(rolling.rotation, 0.3 * ignored.rotation);
  EXPECT_LT(rolling.rates, 0.1);  // of 0.11 rad/s RMS
  EXPECT_LT(rolling.consistency, 2.0);
}

TEST(RollingShutter, KeepsTheTrackInAVibrationAboveHalfTheFrameRate) {
  const Errors rolling = errorsOf({.shake = 0.006, .shake_frequency = 12.0}, shuttersOf(kReadout, 0.0));
  EXPECT_EQ(rolling.valid, kPairs - kSettledPairs);
  EXPECT_LT(rolling.rotation, 0.001);
  EXPECT_LT(rolling.consistency, 2.0);
}

TEST(RollingShutter, RefusesReadoutsThatNoCameraHas) {
  EXPECT_THROW(StereoOdometry(kCamera, {}, shuttersOf(0.5, 0.0)), std::invalid_argument);
  EXPECT_THROW(StereoOdometry(kCamera, {}, shuttersOf(0.03, -1.0)), std::invalid_argument);
  EXPECT_THROW(StereoOdometry(kCamera, {}, shuttersOf(NAN, 0.0)), std::invalid_argument);
}

TEST(RowShares, InterpolateBetweenTheirNodes) {
  const RowShares shares(2, {-0.5F, -0.3F, 0.1F, 0.5F});
  EXPECT_NEAR(shares.at({0.0, 0.0}, 16), -0.5, 1e-6);
  EXPECT_NEAR(shares.at({8.0, 8.0}, 16), -0.05, 1e-6);
  EXPECT_NEAR(shares.at({100.0, 100.0}, 16), 0.5, 1e-6);
  EXPECT_NEAR(RowShares().at({3.0, 0.0}, 16), 0.5 / 16 - 0.5, 1e-12);
  EXPECT_THROW(RowShares(2, {0.0F, 0.0F, 0.0F}), std::invalid_argument);
  EXPECT_THROW(RowShares(1, {0.0F, 0.0F}), std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::vo
