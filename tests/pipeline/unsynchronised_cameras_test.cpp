// Two cameras whose clocks drift apart: pairing and odometry together.

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/pipeline.hpp"
#include "support/capture/synthetic_cameras.hpp"
#include "support/vo_core/corridor_world.hpp"

namespace cartvo::pipeline {
namespace {

const vo::StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr double kPeriod = 0.05;  // s
constexpr int kFrames = 28;

calib::Rig rigOf(const vo::StereoCamera& camera) {
  calib::Rig rig;
  rig.name = "corridor";
  rig.left.size = rig.right.size = {camera.width, camera.height};
  rig.left.fx = rig.left.fy = rig.right.fx = rig.right.fy = camera.focal_length;
  rig.left.cx = rig.right.cx = camera.cx;
  rig.left.cy = rig.right.cy = camera.cy;
  rig.T_right_left.translation() = Eigen::Vector3d(-camera.baseline, 0.0, 0.0);
  rig.T_body_camera = calib::forwardLookingMount();
  return rig;
}

/// Pose of an accelerating cart that swings from side to side.
Eigen::Isometry3d drive(double seconds) {
  vo::Vector6d vector;
  vector << 0.05 * std::sin(2.0 * seconds), 0.0, 2.0 * seconds + 0.5 * seconds * seconds, 0.0,
      0.1 * std::sin(1.5 * seconds), 0.0;
  return vo::motionFromVector(vector);
}

std::int64_t nanoseconds(double seconds) {
  return std::llround(1e9 * seconds);
}

capture::Frame frameOf(cv::Mat image, int index, double seconds) {
  capture::Frame frame;
  frame.image = std::move(image);
  frame.exposure_ns = frame.arrival_ns = frame.decoded_ns = nanoseconds(seconds);
  frame.sequence = static_cast<std::uint64_t>(index);
  return frame;
}

/// Replays the drive with a time offset that starts at `offset` s and grows by `drift` periods with each
/// frame.
std::vector<PairResult> replayDrive(double offset, double drift) {
  const test::CorridorWorld world(1);
  std::vector<capture::Frame> left, right;
  for (int i = 0; i < kFrames; ++i) {
    const double at_left = i * kPeriod, at_right = offset + i * kPeriod * (1.0 + drift);
    left.push_back(frameOf(world.view(kCamera, drive(at_left)), i, at_left));
    right.push_back(frameOf(world.rightView(kCamera, drive(at_right)), i, at_right));
  }
  const calib::Rig rig = rigOf(kCamera);
  const calib::RectificationSettings rectification;
  vo::OdometrySettings odometry;
  odometry.features = 400;
  PairProcessor processor(rig, calib::Rectifier(rig, rectification, calib::buildTables(rig, rectification)),
                          {.odometry = odometry});
  test::ListedCamera left_camera(std::move(left)), right_camera(std::move(right));
  Pipeline pipeline(left_camera, right_camera, processor, {rig.left.size, nanoseconds(kPeriod)});
  std::vector<PairResult> results;
  pipeline.replay({[&](const PairResult& result) { results.push_back(result); }, {}});
  return results;
}

/// Errors of the motions between consecutive pairs, m per period, without the first pair. Where the partners
/// change, one left frame has no partner and the motion covers two periods.
std::vector<double> motionErrors(const std::vector<PairResult>& results) {
  std::vector<double> errors;
  for (std::size_t i = 1; i < results.size(); ++i) {
    EXPECT_TRUE(results[i].estimate.valid) << i;
    EXPECT_EQ(results[i].estimate.reset_counter, 0U) << i;
    const double now = 1e-9 * static_cast<double>(results[i].left.exposure_ns);
    const Eigen::Isometry3d truth = drive(now - results[i].estimate.time_step).inverse() * drive(now);
    const double periods = results[i].estimate.time_step / kPeriod;
    errors.push_back((results[i].estimate.T_previous_current.translation() - truth.translation()).norm() /
                     periods);
  }
  return errors;
}

TEST(UnsynchronisedCameras, MotionStaysAccurateWhenExposureOrderOrPartnersChange) {
  // The offset sweeps one period: from -0.12 through 0 to 0.62 periods, where the partners change.
  const std::vector<PairResult> swept = replayDrive(-0.12 * kPeriod, 1.0 / kFrames);
  int order_changes = 0, partner_changes = 0;
  for (std::size_t i = 1; i < swept.size(); ++i) {
    const double before = 1e-9 * static_cast<double>(swept[i - 1].offset_ns()) / kPeriod;
    const double now = 1e-9 * static_cast<double>(swept[i].offset_ns()) / kPeriod;
    EXPECT_LE(std::abs(now), 0.625 + 1e-6);
    if (before < 0.0 && now >= 0.0) ++order_changes;
    if (before > 0.55 && now < -0.25) ++partner_changes;
  }
  EXPECT_EQ(order_changes, 1);
  EXPECT_EQ(partner_changes, 1);
  EXPECT_GE(swept.size(), static_cast<std::size_t>(kFrames) - 1);

  const std::vector<double> errors = motionErrors(swept);
  const std::vector<double> synchronised_errors = motionErrors(replayDrive(0.0, 0.0));
  ASSERT_FALSE(errors.empty());
  ASSERT_FALSE(synchronised_errors.empty());
  const double worst = *std::max_element(errors.begin(), errors.end());
  const double worst_synchronised = *std::max_element(synchronised_errors.begin(), synchronised_errors.end());
  EXPECT_LT(worst, 1.5 * worst_synchronised);
  EXPECT_LT(worst, 0.002);
}

}  // namespace
}  // namespace cartvo::pipeline
