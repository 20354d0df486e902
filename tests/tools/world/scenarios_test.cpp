// What the scenarios promise, seen in their truth and in small pictures.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tools/world/rendered_world.hpp"
#include "tools/world/steps.hpp"

namespace cartvo {
namespace {

using world::RenderedWorld;
using world::Scenario;
using world::WorldSettings;

WorldSettings smallDrive(Scenario scenario, double seconds = 10.0) {
  WorldSettings settings;
  settings.scenario = scenario;
  settings.seconds = seconds;
  settings.image_size = cv::Size(170, 105);
  settings.focal_length = 120.0;
  return settings;
}

double speedAt(const RenderedWorld& world, double t) {
  constexpr double kStep = 0.05;
  return (world.T_world_body(t + kStep).translation() - world.T_world_body(t).translation()).norm() / kStep;
}

/// The share of the left camera's view that moving objects cover, in every ninth image from `first` on,
/// sorted.
std::vector<double> movingShares(const RenderedWorld& world, int first) {
  std::vector<double> shares;
  for (int index = first; index < world.pairCount(); index += 9) {
    const cv::Mat moving = world.renderDepth(index, CameraSide::left).moving;
    shares.push_back(cv::countNonZero(moving) / static_cast<double>(moving.total()));
  }
  std::sort(shares.begin(), shares.end());
  return shares;
}

TEST(RenderedWorldScenarios, AllShowSomethingEverywhere) {
  for (const Scenario scenario : world::allScenarios()) {
    SCOPED_TRACE(std::string(world::scenarioName(scenario)));
    WorldSettings settings = smallDrive(scenario, 4.0);
    settings.noise = 0.0;
    const cv::Mat image = RenderedWorld(settings).image(70, CameraSide::right);
    double darkest = 0.0;  // what is not a number comes out black
    cv::minMaxLoc(image, &darkest);
    EXPECT_GT(darkest, 0.0);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(image, mean, deviation);
    EXPECT_GT(mean[0], 25.0);
    EXPECT_LT(mean[0], 200.0);
    EXPECT_GT(deviation[0], 10.0);
  }
}

TEST(RenderedWorldScenarios, LoopIsOneLapOfThreeHundredMetres) {
  const RenderedWorld world(smallDrive(Scenario::loop, 85.0));
  double length = 0.0;
  for (const double t : world::stepsBelow(85.0, 0.0, 0.1))
    length += (world.T_world_body(t + 0.1).translation() - world.T_world_body(t).translation()).norm();
  EXPECT_NEAR(length, 300.0, 20.0);
  EXPECT_LT(world.T_world_body(85.0).translation().norm(), 0.2);
  EXPECT_LT(speedAt(world, 84.5), 0.01);
  EXPECT_LT(Eigen::AngleAxisd(world.T_world_body(85.0).linear()).angle(), 0.02);
}

TEST(RenderedWorldScenarios, ReversingDrivesBackward) {
  const RenderedWorld world(smallDrive(Scenario::reversing, 20.0));
  double least_step = 0.0;
  for (const double t : world::stepsBelow(19.0, 0.0, 0.5)) {
    const Eigen::Isometry3d step = world.T_world_body(t).inverse() * world.T_world_body(t + 0.5);
    least_step = std::min(least_step, step.translation().x());
  }
  EXPECT_LT(least_step, -0.5);
}

TEST(RenderedWorldScenarios, MotorwayIsFastFromTheFirstInstant) {
  const RenderedWorld world(smallDrive(Scenario::motorway));
  EXPECT_NEAR(speedAt(world, 0.0), 20.0, 0.1);
  EXPECT_NEAR(speedAt(world, 9.0), 20.0, 0.1);
}

TEST(RenderedWorldScenarios, StopAndGoStopsAgainAndAgain) {
  const RenderedWorld world(smallDrive(Scenario::stop_and_go, 26.0));
  int stops = 0;
  bool moving = false;
  for (const double t : world::stepsBelow(25.0, 2.0, 0.1)) {
    const double speed = speedAt(world, t);
    if (moving && speed < 0.02) ++stops;
    moving = speed > (moving ? 0.02 : 1.0);
  }
  EXPECT_GE(stops, 2);
}

TEST(RenderedWorldScenarios, ExposureJumpsFromOneImageToTheNext) {
  const RenderedWorld world(smallDrive(Scenario::exposure));
  const double before = cv::mean(world.image(143, CameraSide::left))[0];  // the jump is at 8 s
  const double after = cv::mean(world.image(145, CameraSide::left))[0];
  EXPECT_GT(after, 2.0 * before);  // three stops are a factor of 2.6 in grey levels
}

TEST(RenderedWorldScenarios, TrafficCoversTwoFifthsOfTheView) {
  const std::vector<double> shares = movingShares(RenderedWorld(smallDrive(Scenario::traffic, 30.0)), 36);
  EXPECT_GT(shares.back(), 0.4);
  EXPECT_GT(shares[shares.size() / 2], 0.2);
}

TEST(RenderedWorldScenarios, VehiclesPassTheStandingCartForTwentySeconds) {
  const RenderedWorld world(smallDrive(Scenario::standing, 22.0));
  EXPECT_LT(world.T_world_body(21.5).translation().norm(), 1e-6);
  const std::vector<double> shares = movingShares(world, 36);
  EXPECT_GT(shares.back(), 0.3);
  EXPECT_GT(shares[shares.size() / 2], 0.02);
}

TEST(RenderedWorldScenarios, UnderpassTakesTheLightWithinASecondAndGivesItBack) {
  const RenderedWorld world(smallDrive(Scenario::underpass, 20.0));
  std::vector<double> stops;
  constexpr double kStep = 0.25;
  for (const double t : world::stepsBelow(18.0, 2.0, kStep))
    stops.push_back(std::log2(world.light(t)));
  double fall = 0.0;
  double rise = 0.0;
  for (std::size_t i = 4; i < stops.size(); ++i) {
    fall = std::max(fall, stops[i - 4] - stops[i]);
    rise = std::max(rise, stops[i] - stops[i - 4]);
  }
  const auto darkest = std::min_element(stops.begin(), stops.end());
  EXPECT_GT(fall, 2.5);
  EXPECT_GT(rise, 1.2);
  EXPECT_GT(stops.front() - *darkest, 3.5);
  EXPECT_GT(*std::max_element(darkest, stops.end()) - *darkest, 3.5);
}

TEST(RenderedWorldScenarios, GlareBlindsAPartOfThePicture) {
  const RenderedWorld world(smallDrive(Scenario::glare));
  for (const int index : {20, 90, 140}) {
    SCOPED_TRACE(index);
    const cv::Mat image = world.image(index, CameraSide::left);
    const double blinded = cv::countNonZero(image >= 254) / static_cast<double>(image.total());
    EXPECT_GT(blinded, 0.005);
    EXPECT_LT(blinded, 0.15);
    EXPECT_LT(cv::mean(image)[0], 150.0);
  }
}

}  // namespace
}  // namespace cartvo
