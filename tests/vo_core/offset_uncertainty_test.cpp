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

enum class Drive : std::uint8_t { standstill, straight, turn };

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

/// Squared error of the last pose normalised by its covariance (NEES).
double finalNees(const std::vector<OdometryEstimate>& estimates) {
  const OdometryEstimate& last = estimates.back();
  const Vector6d error = vectorFromMotion(last.T_world_camera.inverse() * poseAt(Drive::turn, kPairs - 1));
  return error.dot(last.pose_covariance.ldlt().solve(error));
}

TEST(OffsetUncertainty, IncreasesTheCovarianceOfTheFirstMotion) {
  const auto variance = [](double stddev) {
    return simulateDrive(Drive::turn, 0.0, stddev, 2).back().pose_covariance.trace();
  };
  EXPECT_GT(variance(kOffsetStddev), 1.2 * variance(0.0));
  EXPECT_GT(variance(2.0 * kOffsetStddev), variance(kOffsetStddev));
}

TEST(OffsetUncertainty, HasNoEffectAtStandstill) {
  const auto variance = [](double stddev) {
    return simulateDrive(Drive::standstill, 0.0, stddev).back().motion_covariance.trace();
  };
  EXPECT_NEAR(variance(kOffsetStddev), variance(0.0), 1e-3 * variance(0.0));
}

/// The images of a drive show the offset: it is then known as one that is stated.
TEST(OffsetUncertainty, EndsWithTheDrive) {
  const double known = finalNees(simulateDrive(Drive::turn, 0.0, 0.0));
  for (const double delay : {-kOffsetStddev, kOffsetStddev}) {
    const std::vector<OdometryEstimate> found = simulateDrive(Drive::turn, delay, kOffsetStddev);
    EXPECT_LT(finalNees(found), 1.5 * known) << delay;
    EXPECT_LT((found.back().T_world_camera.inverse() * poseAt(Drive::turn, kPairs - 1)).translation().norm(),
              0.005 * 0.15 * kPairs)
        << delay;
    EXPECT_GT(finalNees(simulateDrive(Drive::turn, delay, 0.0)), 30.0 * known) << delay;
  }
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
