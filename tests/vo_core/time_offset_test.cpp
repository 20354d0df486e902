// Tests of the odometry with a time offset between the left and the right exposure, known or uncertain.
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

enum class Path : std::uint8_t { standstill, straight, turn, weave };

/// Pose at a frame number, which may be fractional.
Eigen::Isometry3d poseAt(Path path, double frame) {
  Vector6d vector = Vector6d::Zero();
  if (path == Path::weave)
    vector << 0.01 * frame, 0.004 * frame, 0.0, 0.001 * frame, 0.05 * std::sin(frame / 8.0), -0.002 * frame;
  if (path != Path::standstill) vector[2] = 0.15 * frame;
  if (path == Path::turn) vector[4] = 0.03 * frame;
  return motionFromVector(vector);
}

/// Renders an image, or returns it from a cache.
cv::Mat image(Path path, double frame, bool is_right) {
  static const test::CorridorWorld world(1);
  static std::map<std::tuple<Path, double, bool>, cv::Mat> images;
  if (path == Path::standstill) frame = 0.0;
  cv::Mat& kept = images[{path, frame, is_right}];
  if (kept.empty()) {
    const Eigen::Isometry3d T = poseAt(path, frame);
    kept = is_right ? world.rightView(kCamera, T) : world.view(kCamera, T);
  }
  return kept;
}

struct Drive {
  Path path = Path::turn;
  double actual = 0.0;  ///< s, right exposure minus left one
  double stated = 0.0;  ///< s, the same in the time stamps
  double stddev = 0.0;  ///< s, the standard deviation that is stated
  int pairs = kPairs;
};

std::vector<OdometryEstimate> estimatesOf(const Drive& drive) {
  OdometrySettings settings;
  settings.features = 400;
  settings.rig_refinement = RigRefinement::off;  // it would take a part of the error for a yaw of the camera
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  std::vector<OdometryEstimate> estimates;
  for (int i = 0; i < drive.pairs; ++i) {
    const StereoImages pair{image(drive.path, i, false),
                            image(drive.path, i + drive.actual * 1e9 / kPeriod, true), i * kPeriod,
                            i * kPeriod + std::llround(drive.stated * 1e9), drive.stddev};
    estimates.push_back(odometry.process(pair, observer));
  }
  return estimates;
}

/// Error of the last position of a weaving drive in percent of the distance.
double finalError(double actual, double stated) {
  constexpr int kWeaving = 12;
  const auto estimates = estimatesOf({Path::weave, actual, stated, 0.0, kWeaving});
  for (int i = 0; i < kWeaving; ++i)
    EXPECT_TRUE(i == 0 || estimates[i].valid || stated != actual) << i;
  const Eigen::Vector3d truth = poseAt(Path::weave, kWeaving - 1).translation();
  return 100.0 * (estimates.back().T_world_camera.translation() - truth).norm() / truth.norm();
}

TEST(TimeOffset, IsCompensated) {
  for (const double offset : {0.0, 0.02, -0.02}) {
    const double error = finalError(offset, offset);
    RecordProperty("percent_at_" + std::to_string(offset), std::to_string(error));
    EXPECT_LT(error, 0.5) << offset;
  }
}

TEST(TimeOffset, CausesErrorsIfIgnored) {
  for (const double offset : {0.02, -0.02})
    EXPECT_GT(finalError(offset, 0.0), 3.0) << offset;
}

/// Squared error of the last pose of a turn normalised by its covariance (NEES).
double finalNees(const std::vector<OdometryEstimate>& estimates) {
  const OdometryEstimate& last = estimates.back();
  const Vector6d error = vectorFromMotion(last.T_world_camera.inverse() * poseAt(Path::turn, kPairs - 1));
  return error.dot(last.pose_covariance.ldlt().solve(error));
}

TEST(OffsetUncertainty, IncreasesTheCovarianceOfTheFirstMotion) {
  const auto variance = [](double stddev) {
    return estimatesOf({.stddev = stddev, .pairs = 2}).back().pose_covariance.trace();
  };
  EXPECT_GT(variance(kOffsetStddev), 1.2 * variance(0.0));
  EXPECT_GT(variance(2.0 * kOffsetStddev), variance(kOffsetStddev));
}

TEST(OffsetUncertainty, HasNoEffectAtStandstill) {
  const auto variance = [](double stddev) {
    return estimatesOf({.path = Path::standstill, .stddev = stddev}).back().motion_covariance.trace();
  };
  EXPECT_NEAR(variance(kOffsetStddev), variance(0.0), 1e-3 * variance(0.0));
}

/// The images of a drive show the offset: it is then known as one that is stated.
TEST(OffsetUncertainty, EndsWithTheDrive) {
  const double known = finalNees(estimatesOf({}));
  for (const double delay : {-kOffsetStddev, kOffsetStddev}) {
    const std::vector<OdometryEstimate> found = estimatesOf({.actual = delay, .stddev = kOffsetStddev});
    EXPECT_LT(finalNees(found), 1.5 * known) << delay;
    EXPECT_LT((found.back().T_world_camera.inverse() * poseAt(Path::turn, kPairs - 1)).translation().norm(),
              0.005 * 0.15 * kPairs)
        << delay;
    EXPECT_GT(finalNees(estimatesOf({.actual = delay})), 30.0 * known) << delay;
  }
}

TEST(OffsetUncertainty, InvalidatesEstimatesBeyondItsLimit) {
  const double limit = ValiditySettings{}.maximum_offset_uncertainty;
  EXPECT_TRUE(estimatesOf({.path = Path::straight, .stddev = 0.9 * limit}).back().valid);
  const OdometryEstimate beyond = estimatesOf({.path = Path::straight, .stddev = 1.1 * limit}).back();
  EXPECT_FALSE(beyond.valid);
  EXPECT_EQ(beyond.reasons, OdometryReason::offset_uncertain);
}

}  // namespace
}  // namespace cartvo::vo
