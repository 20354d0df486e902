// Tests of RenderedWorld: determinism, clocks, truth, lens model and settings.
#include "lab/render/rendered_world.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "lab/render/scene/steps.hpp"
#include "lab/render/tracing/lens.hpp"

namespace cartvo {
namespace {

using world::RenderedWorld;
using world::Scenario;
using world::WorldSettings;

WorldSettings smallDrive() {
  WorldSettings settings;
  settings.seconds = 10.0;
  settings.image_size = cv::Size(170, 105);
  settings.focal_length = 120.0;
  return settings;
}

WorldSettings smallDrive(Scenario scenario) {
  WorldSettings settings = smallDrive();
  settings.scenario = scenario;
  return settings;
}

double meanDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

TEST(RenderedWorld, SameSettingsGiveTheSameBytesWithAnyThreadCount) {
  WorldSettings settings = smallDrive();
  settings.threads = 1;
  const RenderedWorld one(settings);
  settings.threads = 3;
  const RenderedWorld three(settings);
  cv::Mat left[2];
  cv::Mat right[2];
  one.images(60, left[0], right[0]);
  three.images(61, left[1], right[1]);  // an image must not depend on images rendered before
  three.images(60, left[1], right[1]);
  EXPECT_EQ(cv::norm(left[0], left[1], cv::NORM_L1), 0.0);
  EXPECT_EQ(cv::norm(right[0], right[1], cv::NORM_L1), 0.0);
  EXPECT_EQ(one.cacheKey(), three.cacheKey());
}

TEST(RenderedWorld, DifferentSeedGivesDifferentCampus) {
  WorldSettings settings = smallDrive();
  const RenderedWorld first(settings);
  settings.seed = 2;
  const RenderedWorld second(settings);
  EXPECT_GT(
      meanDifference(first.image(50, capture::CameraSide::left), second.image(50, capture::CameraSide::left)),
      5.0);
  EXPECT_NE(first.cacheKey(), second.cacheKey());
}

TEST(RenderedWorld, StaticSceneDoesNotFlickerAtStandstill) {
  WorldSettings settings = smallDrive(Scenario::standing);
  settings.noise = 0.0;
  const RenderedWorld world(settings);
  const auto static_mask = [&](int index) -> cv::Mat {  // excludes moving objects and a margin of 2 px
    const cv::Mat moving = world.renderDepth(index, capture::CameraSide::left).moving;
    cv::Mat still;
    cv::erode(moving == 0, still, cv::Mat(), cv::Point(-1, -1), 2);
    return still;
  };
  const cv::Mat still = static_mask(60) & static_mask(61);
  cv::Mat change;
  cv::absdiff(world.image(60, capture::CameraSide::left), world.image(61, capture::CameraSide::left), change);
  const int changed = cv::countNonZero((change > 1) & still);  // moving shadows
  EXPECT_LT(changed, 0.015 * cv::countNonZero(still));
  EXPECT_GT(cv::countNonZero(still), 0.5 * static_cast<double>(still.total()));
}

TEST(RenderedWorld, RightCameraHasTimeOffsetAndDrift) {
  WorldSettings settings = smallDrive();
  settings.offset_s = 0.02;
  settings.offset_drift_ppm = 50.0;
  const RenderedWorld world(settings);
  EXPECT_EQ(world.leftInstant(18), 1'000'000'000);
  EXPECT_EQ(world.rightInstant(18), 1'020'050'000);
  EXPECT_EQ(world.pairCount(), 180);
}

TEST(RenderedWorld, RightImageShowsTheSceneAtItsOwnExposure) {
  WorldSettings settings = smallDrive();
  settings.noise = 0.0;
  const RenderedWorld simultaneous(settings);
  settings.offset_s = 1.0 / settings.frame_rate;  // one frame period
  const RenderedWorld offset(settings);
  const cv::Mat image = offset.image(100, capture::CameraSide::right);
  const double to_next = meanDifference(image, simultaneous.image(101, capture::CameraSide::right));
  const double to_same = meanDifference(image, simultaneous.image(100, capture::CameraSide::right));
  EXPECT_LT(to_next, 0.5 * to_same);
}

constexpr int kPassing = 150;  // index of an image that a vehicle crosses

/// An image of the standing cart, which a vehicle passes, with the right camera exposed `offset_s` later.
cv::Mat rightWhileStanding(double right_readout, double offset_s) {
  WorldSettings settings = smallDrive(Scenario::standing);
  settings.right_readout = right_readout;
  settings.offset_s = offset_s;
  return RenderedWorld(settings).radiance(kPassing, capture::CameraSide::right);
}

TEST(RenderedWorld, RowsOfARollingShutterShowMovingObjectsAtTheirOwnInstants) {
  constexpr double kReadout = -0.05;
  const cv::Mat rolling = rightWhileStanding(kReadout, 0.0);
  double to_own = 0.0, to_opposite = 0.0;
  for (const int row : {36, 66}) {
    const double instant = kReadout * ((row + 0.5) / rolling.rows - 0.5);
    to_own += cv::norm(rolling.row(row), rightWhileStanding(0.0, instant).row(row), cv::NORM_L1);
    to_opposite += cv::norm(rolling.row(row), rightWhileStanding(0.0, -instant).row(row), cv::NORM_L1);
  }
  EXPECT_GT(to_opposite, 0.05) << "objects move";
  EXPECT_LT(to_own, 0.1 * to_opposite);
}

TEST(RenderedWorld, InstantsOfRowsSpanTheReadoutAroundThatOfTheImage) {
  WorldSettings settings = smallDrive();
  settings.offset_s = 0.02;
  settings.left_readout = 0.032;
  settings.right_readout = -0.03;
  const RenderedWorld world(settings);
  const double lower_edge = settings.image_size.height - 0.5;
  EXPECT_NEAR(world.rowInstant(18, capture::CameraSide::left, -0.5), 1.0 - 0.016, 1e-9);
  EXPECT_NEAR(world.rowInstant(18, capture::CameraSide::left, lower_edge), 1.0 + 0.016, 1e-9);
  EXPECT_NEAR(world.rowInstant(18, capture::CameraSide::right, lower_edge), 1.02 - 0.015, 1e-9);
  EXPECT_EQ(world.rig().left.readout, 0.032);
  EXPECT_EQ(world.rig().right.readout, -0.03);
}

TEST(RenderedWorld, CacheKeyTellsReadoutsAndVibrationsApart) {
  WorldSettings settings = smallDrive();
  std::set<std::string> keys{RenderedWorld(settings).cacheKey()};
  settings.left_readout = 0.032;
  keys.insert(RenderedWorld(settings).cacheKey());
  settings.right_readout = 0.032;
  keys.insert(RenderedWorld(settings).cacheKey());
  settings.shake = {8.0, 0.005};
  keys.insert(RenderedWorld(settings).cacheKey());
  settings.shake.frequency = 5.0;
  keys.insert(RenderedWorld(settings).cacheKey());
  EXPECT_EQ(keys.size(), 5u);
}

TEST(RenderedWorld, ShakenMountTurnsTheCamerasAboutTheirPlaceAfterTheLeadIn) {
  WorldSettings settings = smallDrive(Scenario::standing);
  settings.lead_in_seconds = 1.0;
  settings.shake = {5.0, 0.01};
  const RenderedWorld world(settings);
  EXPECT_TRUE(world.T_world_body(1.0).isApprox(Eigen::Isometry3d::Identity(), 1e-12));
  const calib::Rig rig = world.rig();
  double largest = 0.0;
  for (const double t : world::stepsBelow(4.0, 2.0, 0.005)) {
    const Eigen::Isometry3d shaken = world.T_world_body(t);
    largest = std::max(largest, Eigen::AngleAxisd(shaken.linear()).angle());
    const Eigen::Vector3d left = rig.T_body_camera.translation();
    EXPECT_LT((shaken * left - left).norm(), 0.001) << t;
    EXPECT_TRUE(shaken.isApprox(world.T_world_body(t + 0.2), 1e-9)) << "a period later";
  }
  EXPECT_GT(largest, 0.01);
  EXPECT_LT(largest, 0.0125);
}

TEST(RenderedWorld, DenseTruthHasFurtherPosesBetweenThoseOfTheImages) {
  const RenderedWorld world(smallDrive());
  const Trajectory truth = world.truth(), dense = world.denseTruth();
  ASSERT_EQ(dense.size(), 5 * (truth.size() - 1) + 1);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(dense[5 * i].time_ns, truth[i].time_ns);
    EXPECT_TRUE(dense[5 * i].pose.isApprox(truth[i].pose, 0.0));
  }
}

TEST(RenderedWorld, TruthStartsAtTheOriginAndIsSmooth) {
  for (const Scenario scenario : world::allScenarios()) {
    SCOPED_TRACE(std::string(world::scenarioName(scenario)));
    const RenderedWorld world(smallDrive(scenario));
    EXPECT_TRUE(world.T_world_body(0.0).isApprox(Eigen::Isometry3d::Identity(), 1e-12));
    ASSERT_FALSE(world.truth().empty());
    EXPECT_TRUE(world.truth().front().pose.isApprox(Eigen::Isometry3d::Identity(), 1e-12));
    constexpr double kStep = 0.005;
    for (const double t : world::stepsBelow(9.8, 0.1, kStep)) {
      const Eigen::Vector3d before = world.T_world_body(t - kStep).translation();
      const Eigen::Vector3d here = world.T_world_body(t).translation();
      const Eigen::Vector3d after = world.T_world_body(t + kStep).translation();
      EXPECT_LT((after - here).norm() / kStep, scenario == Scenario::motorway ? 21.0 : 7.0)
          << "speed at " << t;
      EXPECT_LT((after - 2.0 * here + before).norm() / (kStep * kStep),
                scenario == Scenario::rough_road ? 40.0 : 25.0)
          << "acceleration at " << t;
    }
  }
}

TEST(RenderedWorld, LeadInIsAStandstill) {
  WorldSettings settings = smallDrive();
  settings.lead_in_seconds = 3.0;
  const RenderedWorld world(settings);
  EXPECT_TRUE(world.T_world_body(2.99).isApprox(Eigen::Isometry3d::Identity(), 1e-9));
  EXPECT_GT(world.T_world_body(8.0).translation().norm(), 3.0);
}

TEST(RenderedWorld, UndistortInvertsDistort) {
  const calib::Rig rig = world::simulatedRig(WorldSettings{});
  for (const calib::CameraModel* camera : {&rig.left, &rig.right}) {
    for (const double y : world::stepsBelow(camera->size.height, -0.5, 20.0)) {
      for (const double x : world::stepsBelow(camera->size.width, -0.5, 20.0)) {
        const Eigen::Vector2d pixel(x, y);
        EXPECT_LT((world::distort(*camera, world::undistort(*camera, pixel)) - pixel).norm(), 1e-9);
      }
    }
  }
  const world::RayTable table(rig.left);
  const Eigen::Vector2d between(17.3, 401.8);
  EXPECT_LT((table.direction(17.3F, 401.8F).cast<double>() - world::undistort(rig.left, between)).norm(),
            1e-6);
}

TEST(RenderedWorld, RejectsSettingsOutOfRange) {
  WorldSettings settings;
  settings.seconds = 0.0;
  EXPECT_THROW(RenderedWorld{settings}, std::invalid_argument);
  settings = WorldSettings{};
  settings.edge_samples = 3;
  EXPECT_THROW(RenderedWorld{settings}, std::invalid_argument);
  settings = WorldSettings{};
  settings.right_readout = -0.06;  // longer than the frame period
  EXPECT_THROW(RenderedWorld{settings}, std::invalid_argument);
  settings = WorldSettings{};
  settings.shake.amplitude = 1.0;
  EXPECT_THROW(RenderedWorld{settings}, std::invalid_argument);
  EXPECT_THROW(world::scenarioFromName("moon"), std::invalid_argument);
  EXPECT_EQ(world::scenarioFromName("stop_and_go"), Scenario::stop_and_go);
}

}  // namespace
}  // namespace cartvo
