// What the odometry makes of a right camera that is exposed at another instant.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns
constexpr int kPairs = 12;

/// Goes on steadily, swinging a little from side to side; `frame` may lie between two.
Eigen::Isometry3d drive(double frame) {
  Vector6d vector;
  vector << 0.01 * frame, 0.004 * frame, 0.15 * frame, 0.001 * frame, 0.05 * std::sin(frame / 8.0),
      -0.002 * frame;
  return motionFromVector(vector);
}

/// Each image is rendered once.
cv::Mat image(double frame, bool is_right) {
  static const test::CorridorWorld world(1);
  static std::map<std::pair<double, bool>, cv::Mat> images;
  cv::Mat& kept = images[{frame, is_right}];
  if (kept.empty())
    kept = is_right ? world.rightView(kCamera, drive(frame)) : world.view(kCamera, drive(frame));
  return kept;
}

/// How far the last pose is off, in percent of the way. `told_periods`: the offset that the odometry is told.
double finalError(double offset_periods, double told_periods) {
  OdometrySettings settings;
  settings.features = 400;
  settings.rig_refinement = RigRefinement::off;  // would take a part of the error for a turned camera
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  OdometryEstimate estimate;
  for (int i = 0; i < kPairs; ++i) {
    const StereoImages pair{image(i, false), image(i + offset_periods, true), i * kPeriod,
                            i * kPeriod + std::llround(told_periods * kPeriod)};
    estimate = odometry.process(pair, observer);
    EXPECT_TRUE(i == 0 || estimate.valid) << i;
  }
  const Eigen::Isometry3d truth = drive(kPairs - 1);
  return 100.0 * (estimate.T_world_camera.translation() - truth.translation()).norm() /
         truth.translation().norm();
}

TEST(TwoInstants, AreAsGoodAsOne) {
  for (const double offset : {0.0, 0.4, -0.4}) {
    const double error = finalError(offset, offset);
    RecordProperty("percent_at_" + std::to_string(offset), std::to_string(error));
    EXPECT_LT(error, 0.5) << offset;
  }
}

TEST(TwoInstants, TakenAsOneAreWrong) {
  for (const double offset : {0.4, -0.4})
    EXPECT_GT(finalError(offset, 0.0), 3.0) << offset;
}

}  // namespace
}  // namespace cartvo
