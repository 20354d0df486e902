// Tests of the covariance with an uncertain time offset.
#include <Eigen/Cholesky>
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns
constexpr double kOffsetStddev = 0.003;       // s
constexpr int kPairs = 10;

enum class Drive { standstill, straight, turn };

Eigen::Isometry3d poseAt(Drive drive, double frame) {
  Vector6d vector = Vector6d::Zero();
  if (drive != Drive::standstill) vector[2] = 0.15 * frame;
  if (drive == Drive::turn) vector[4] = 0.03 * frame;
  return motionFromVector(vector);
}

/// Renders an image, or returns it from a cache.
cv::Mat image(Drive drive, double frame, bool is_right) {
  static const test::CorridorWorld world(1);
  static std::map<std::tuple<Drive, double, bool>, cv::Mat> images;
  cv::Mat& kept = images[{drive, frame, is_right}];
  if (kept.empty()) {
    const Eigen::Isometry3d T = poseAt(drive, frame);
    kept = is_right ? world.rightView(kCamera, T) : world.view(kCamera, T);
  }
  return kept;
}

/// Runs the odometry on a drive. `delay`: s, right exposure minus its timestamp; `stddev`: s, stated stddev
/// of the time offset.
std::vector<OdometryEstimate> simulateDrive(Drive drive, double delay, double stddev, int pairs = kPairs) {
  OdometrySettings settings;
  settings.features = 400;
  settings.rig_refinement = RigRefinement::off;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  std::vector<OdometryEstimate> estimates;
  for (int i = 0; i < pairs; ++i) {
    const double right = drive == Drive::standstill ? 0.0 : i + delay * 1e9 / kPeriod;
    const StereoImages pair{image(drive, drive == Drive::standstill ? 0.0 : i, false),
                            image(drive, right, true), i * kPeriod, i * kPeriod, stddev};
    estimates.push_back(odometry.process(pair, observer));
  }
  return estimates;
}

double motionVariance(Drive drive, double stddev) {
  return simulateDrive(drive, 0.0, stddev).back().motion_covariance.trace();
}

/// Squared error of the last pose normalised by its covariance (NEES).
double finalNees(const std::vector<OdometryEstimate>& estimates) {
  const OdometryEstimate& last = estimates.back();
  const Vector6d error = vectorFromMotion(last.T_world_camera.inverse() * poseAt(Drive::turn, kPairs - 1));
  return error.dot(last.pose_covariance.ldlt().solve(error));
}

TEST(OffsetUncertainty, IncreasesTheCovarianceInATurn) {
  EXPECT_GT(motionVariance(Drive::turn, kOffsetStddev), 4.0 * motionVariance(Drive::turn, 0.0));
  EXPECT_GT(motionVariance(Drive::turn, 2.0 * kOffsetStddev), motionVariance(Drive::turn, kOffsetStddev));
}

TEST(OffsetUncertainty, MattersMoreInATurnThanOnAStraightDrive) {
  const auto added = [](Drive drive) {
    return simulateDrive(drive, 0.0, kOffsetStddev).back().motion_offset_error;
  };
  EXPECT_GT(added(Drive::turn).head<3>().norm(), 1.5 * added(Drive::straight).head<3>().norm());
}

TEST(OffsetUncertainty, HasNoEffectAtStandstill) {
  EXPECT_NEAR(motionVariance(Drive::standstill, kOffsetStddev), motionVariance(Drive::standstill, 0.0),
              1e-3 * motionVariance(Drive::standstill, 0.0));
}

TEST(OffsetUncertainty, CoversTheErrorOfAWrongOffset) {
  for (const double delay : {-kOffsetStddev, kOffsetStddev}) {
    EXPECT_LT(finalNees(simulateDrive(Drive::turn, delay, kOffsetStddev)), 12.6)
        << delay;  // 95 % of chi-squared, 6
    EXPECT_GT(finalNees(simulateDrive(Drive::turn, delay, 0.0)), 30.0) << delay;
  }
}

TEST(OffsetUncertainty, AccumulatesOverPosesWithItsSign) {
  // An offset error of one stddev moves the pose by the stated amount.
  const Eigen::Vector3d moved =
      simulateDrive(Drive::turn, kOffsetStddev, kOffsetStddev).back().T_world_camera.translation() -
      simulateDrive(Drive::turn, 0.0, kOffsetStddev).back().T_world_camera.translation();
  const OdometryEstimate known = simulateDrive(Drive::turn, 0.0, 0.0).back();
  const OdometryEstimate uncertain = simulateDrive(Drive::turn, 0.0, kOffsetStddev).back();
  const Matrix6d added = uncertain.pose_covariance - known.pose_covariance;
  const Eigen::Vector3d direction = uncertain.T_world_camera.linear().transpose() * moved.normalized();
  const double stated = std::sqrt(direction.dot(added.topLeftCorner<3, 3>() * direction));
  EXPECT_GT(stated, 0.8 * moved.norm());
  EXPECT_LT(stated, 1.5 * moved.norm());
}

TEST(OffsetUncertainty, IsBoundedOnALongDrive) {
  // The error of one motion converges although landmarks change their anchors again and again.
  const std::vector<OdometryEstimate> estimates = simulateDrive(Drive::straight, 0.0, kOffsetStddev, 60);
  const double half_way = estimates[30].motion_offset_error.norm();
  EXPECT_LT(estimates.back().motion_offset_error.norm(), 2.0 * half_way);
  EXPECT_LT(estimates.back().motion_offset_error.head<3>().norm(), 0.05 * 0.15);
}

TEST(OffsetUncertainty, InvalidatesEstimatesBeyondItsLimit) {
  const double limit = ValiditySettings{}.maximum_offset_uncertainty;
  EXPECT_TRUE(simulateDrive(Drive::straight, 0.0, 0.9 * limit).back().valid);
  const OdometryEstimate beyond = simulateDrive(Drive::straight, 0.0, 1.1 * limit).back();
  EXPECT_FALSE(beyond.valid);
  EXPECT_EQ(beyond.reasons, OdometryReason::offset_uncertain);
}

}  // namespace
}  // namespace cartvo::vo
