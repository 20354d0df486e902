// Tests of the odometry with a time offset between the left and the right exposure.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns
constexpr int kPairs = 12;

/// Pose at a frame number, which may be fractional: constant speed with a small oscillation of the heading.
Eigen::Isometry3d drive(double frame) {
  Vector6d vector;
  vector << 0.01 * frame, 0.004 * frame, 0.15 * frame, 0.001 * frame, 0.05 * std::sin(frame / 8.0),
      -0.002 * frame;
  return motionFromVector(vector);
}

/// Renders an image, or returns it from a cache.
cv::Mat image(double frame, bool is_right) {
  static const test::CorridorWorld world(1);
  static std::map<std::pair<double, bool>, cv::Mat> images;
  cv::Mat& kept = images[{frame, is_right}];
  if (kept.empty())
    kept = is_right ? world.rightView(kCamera, drive(frame)) : world.view(kCamera, drive(frame));
  return kept;
}

/// Error of the last position in percent of the distance. Both offsets are in frame periods; `assumed` is the
/// one in the timestamps.
double finalError(double actual, double assumed) {
  OdometrySettings settings;
  settings.features = 400;
  settings.rig_refinement =
      RigRefinement::off;  // it would attribute a part of the error to a yaw of the camera
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  OdometryEstimate estimate;
  for (int i = 0; i < kPairs; ++i) {
    const StereoImages pair{image(i, false), image(i + actual, true), i * kPeriod,
                            i * kPeriod + std::llround(assumed * kPeriod)};
    estimate = odometry.process(pair, observer);
    EXPECT_TRUE(i == 0 || estimate.valid || assumed != actual) << i;
  }
  const Eigen::Isometry3d truth = drive(kPairs - 1);
  return 100.0 * (estimate.T_world_camera.translation() - truth.translation()).norm() /
         truth.translation().norm();
}

TEST(TimeOffset, IsCompensated) {
  for (const double offset : {0.0, 0.4, -0.4}) {
    const double error = finalError(offset, offset);
    RecordProperty("percent_at_" + std::to_string(offset), std::to_string(error));
    EXPECT_LT(error, 0.5) << offset;
  }
}

TEST(TimeOffset, CausesErrorsIfIgnored) {
  for (const double offset : {0.4, -0.4})
    EXPECT_GT(finalError(offset, 0.0), 3.0) << offset;
}

}  // namespace
}  // namespace cartvo::vo
