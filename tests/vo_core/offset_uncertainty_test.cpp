// What is made of an offset that is not known exactly.
#include <Eigen/Cholesky>
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns
constexpr double kDeviation = 0.003;          // s
constexpr int kPairs = 10;

enum class Drive { stand, straight, turn };

Eigen::Isometry3d poseAt(Drive drive, double frame) {
  Vector6d vector = Vector6d::Zero();
  if (drive != Drive::stand) vector[2] = 0.15 * frame;
  if (drive == Drive::turn) vector[4] = 0.03 * frame;
  return motionFromVector(vector);
}

/// Each image is rendered once.
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

/// `late`: s by which the right camera is exposed later than its stamps say.
std::vector<OdometryEstimate> drivenWith(Drive drive, double late, double deviation, int pairs = kPairs) {
  OdometrySettings settings;
  settings.features = 400;
  settings.rig_refinement = RigRefinement::off;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  std::vector<OdometryEstimate> estimates;
  for (int i = 0; i < pairs; ++i) {
    const double right = drive == Drive::stand ? 0.0 : i + late * 1e9 / kPeriod;
    const StereoImages pair{image(drive, drive == Drive::stand ? 0.0 : i, false), image(drive, right, true),
                            i * kPeriod, i * kPeriod, deviation};
    estimates.push_back(odometry.process(pair, observer));
  }
  return estimates;
}

double motionVariance(Drive drive, double deviation) {
  return drivenWith(drive, 0.0, deviation).back().motion_covariance.trace();
}

/// Error of the last pose, squared, normalised by its covariance.
double finalNees(const std::vector<OdometryEstimate>& estimates) {
  const OdometryEstimate& last = estimates.back();
  const Vector6d error = vectorFromMotion(last.T_world_camera.inverse() * poseAt(Drive::turn, kPairs - 1));
  return error.dot(last.pose_covariance.ldlt().solve(error));
}

TEST(OffsetUncertainty, WidensTheCovarianceOfATurn) {
  EXPECT_GT(motionVariance(Drive::turn, kDeviation), 4.0 * motionVariance(Drive::turn, 0.0));
  EXPECT_GT(motionVariance(Drive::turn, 2.0 * kDeviation), motionVariance(Drive::turn, kDeviation));
}

TEST(OffsetUncertainty, WidensThatOfATurnMoreThanThatOfAStraightDrive) {
  const auto added = [](Drive drive) {
    return drivenWith(drive, 0.0, kDeviation).back().motion_offset_error;
  };
  EXPECT_GT(added(Drive::turn).head<3>().norm(), 1.5 * added(Drive::straight).head<3>().norm());
}

TEST(OffsetUncertainty, IsNothingToACartThatStands) {
  EXPECT_NEAR(motionVariance(Drive::stand, kDeviation), motionVariance(Drive::stand, 0.0),
              1e-3 * motionVariance(Drive::stand, 0.0));
}

TEST(OffsetUncertainty, CoversTheErrorOfAnOffsetThatIsOffByIt) {
  for (const double late : {-kDeviation, kDeviation}) {
    EXPECT_LT(finalNees(drivenWith(Drive::turn, late, kDeviation)), 12.6) << late;  // 95 % of chi-squared, 6
    EXPECT_GT(finalNees(drivenWith(Drive::turn, late, 0.0)), 30.0) << late;
  }
}

TEST(OffsetUncertainty, AddsUpOverPosesWithItsSign) {
  // An offset that is wrong by as much as is admitted moves the pose as far as was said.
  const Eigen::Vector3d moved =
      drivenWith(Drive::turn, kDeviation, kDeviation).back().T_world_camera.translation() -
      drivenWith(Drive::turn, 0.0, kDeviation).back().T_world_camera.translation();
  const OdometryEstimate known = drivenWith(Drive::turn, 0.0, 0.0).back();
  const OdometryEstimate uncertain = drivenWith(Drive::turn, 0.0, kDeviation).back();
  const Matrix6d added = uncertain.pose_covariance - known.pose_covariance;
  const Eigen::Vector3d direction = uncertain.T_world_camera.linear().transpose() * moved.normalized();
  const double said = std::sqrt(direction.dot(added.topLeftCorner<3, 3>() * direction));
  EXPECT_GT(said, 0.8 * moved.norm());
  EXPECT_LT(said, 1.5 * moved.norm());
}

TEST(OffsetUncertainty, SettlesOnALongDrive) {
  // What an offset does to one motion comes to rest, however often landmarks hand their depths on.
  const std::vector<OdometryEstimate> estimates = drivenWith(Drive::straight, 0.0, kDeviation, 60);
  const double half_way = estimates[30].motion_offset_error.norm();
  EXPECT_LT(estimates.back().motion_offset_error.norm(), 2.0 * half_way);
  EXPECT_LT(estimates.back().motion_offset_error.head<3>().norm(), 0.05 * 0.15);
}

TEST(OffsetUncertainty, BeyondItsLimitIsNoEstimate) {
  const double limit = ValiditySettings{}.maximum_offset_uncertainty;
  EXPECT_TRUE(drivenWith(Drive::straight, 0.0, 0.9 * limit).back().valid);
  const OdometryEstimate beyond = drivenWith(Drive::straight, 0.0, 1.1 * limit).back();
  EXPECT_FALSE(beyond.valid);
  EXPECT_EQ(beyond.reasons, OdometryReason::offset_uncertain);
}

}  // namespace
}  // namespace cartvo
