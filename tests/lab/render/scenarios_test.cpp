// Verifies the properties of the scenarios on true poses and small images.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "lab/render/rendered_world.hpp"
#include "lab/render/scene/steps.hpp"
#include "lab/render/tracing/photometry.hpp"

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

/// Fraction of the left image that moving objects cover, for every ninth image from `first` on, sorted.
std::vector<double> sortedMovingFractions(const RenderedWorld& world, int first) {
  std::vector<double> shares;
  for (int index = first; index < world.pairCount(); index += 9) {
    const cv::Mat moving = world.renderDepth(index, capture::CameraSide::left).moving;
    shares.push_back(cv::countNonZero(moving) / static_cast<double>(moving.total()));
  }
  std::sort(shares.begin(), shares.end());
  return shares;
}

TEST(RenderedWorldScenarios, ImagesHaveContrastAndNoBlackPixels) {
  for (const Scenario scenario : world::allScenarios()) {
    SCOPED_TRACE(std::string(world::scenarioName(scenario)));
    WorldSettings settings = smallDrive(scenario, 4.0);
    settings.noise = 0.0;
    const cv::Mat image = RenderedWorld(settings).image(70, capture::CameraSide::right);
    double darkest = 0.0;  // NaN radiance becomes black
    cv::minMaxLoc(image, &darkest);
    EXPECT_GT(darkest, 0.0);
    cv::Scalar mean;
    cv::Scalar stddev;
    cv::meanStdDev(image, mean, stddev);
    EXPECT_GT(mean[0], 25.0);
    EXPECT_LT(mean[0], 200.0);
    EXPECT_GT(stddev[0], 10.0);
  }
}

TEST(RenderedWorldScenarios, LoopIsOneLapOf300Metres) {
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
  double min_step = 0.0;
  for (const double t : world::stepsBelow(19.0, 0.0, 0.5)) {
    const Eigen::Isometry3d step = world.T_world_body(t).inverse() * world.T_world_body(t + 0.5);
    min_step = std::min(min_step, step.translation().x());
  }
  EXPECT_LT(min_step, -0.5);
}

TEST(RenderedWorldScenarios, MotorwayStartsAtFullSpeed) {
  const RenderedWorld world(smallDrive(Scenario::motorway));
  EXPECT_NEAR(speedAt(world, 0.0), 20.0, 0.1);
  EXPECT_NEAR(speedAt(world, 9.0), 20.0, 0.1);
}

TEST(RenderedWorldScenarios, RoughRoadAcceleratesTheCamerasByThreeG) {
  const RenderedWorld world(smallDrive(Scenario::rough_road, 20.0));
  const Eigen::Isometry3d T_body_camera = world.rig().T_body_camera;
  const auto height = [&](double t) { return (world.T_world_body(t) * T_body_camera).translation().z(); };
  constexpr double kStep = 0.002;
  double largest = 0.0;
  for (const double t : world::stepsBelow(19.9, 2.0, kStep)) {
    const double acceleration = (height(t + kStep) - 2.0 * height(t) + height(t - kStep)) / (kStep * kStep);
    largest = std::max(largest, std::abs(acceleration));
  }
  EXPECT_NEAR(largest, 30.0, 6.0);
}

TEST(RenderedWorldScenarios, StopAndGoStopsRepeatedly) {
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

TEST(RenderedWorldScenarios, ExposureJumpsWithinTwoFrames) {
  const RenderedWorld world(smallDrive(Scenario::exposure));
  const double before = cv::mean(world.image(143, capture::CameraSide::left))[0];  // the jump is at 8 s
  const double after = cv::mean(world.image(145, capture::CameraSide::left))[0];
  EXPECT_GT(after, 2.0 * before);  // three stops are a factor of 2.6 in grey levels
}

TEST(RenderedWorldScenarios, TrafficCoversUpTo40PercentOfTheImage) {
  const std::vector<double> shares =
      sortedMovingFractions(RenderedWorld(smallDrive(Scenario::traffic, 30.0)), 36);
  ASSERT_FALSE(shares.empty());
  EXPECT_GT(shares.back(), 0.4);
  EXPECT_GT(shares[shares.size() / 2], 0.2);
}

TEST(RenderedWorldScenarios, VehiclesPassTheCartAtStandstill) {
  const RenderedWorld world(smallDrive(Scenario::standing, 22.0));
  EXPECT_LT(world.T_world_body(21.5).translation().norm(), 1e-6);
  const std::vector<double> shares = sortedMovingFractions(world, 36);
  ASSERT_FALSE(shares.empty());
  EXPECT_GT(shares.back(), 0.3);
  EXPECT_GT(shares[shares.size() / 2], 0.02);
}

TEST(RenderedWorldScenarios, UnderpassDarkensAndBrightensWithinOneSecond) {
  const RenderedWorld world(smallDrive(Scenario::underpass, 20.0));
  std::vector<double> stops;
  constexpr double kStep = 0.25;
  for (const double t : world::stepsBelow(18.0, 2.0, kStep))
    stops.push_back(std::log2(world.meanRadiance(t)));
  ASSERT_FALSE(stops.empty());
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

/// Largest and smallest pitch of the body in the axes of its start, rad; nose down is positive.
std::pair<double, double> pitchRange(const RenderedWorld& world, double seconds) {
  double low = 0.0, high = 0.0;
  for (const double t : world::stepsBelow(seconds, 0.0, 0.1)) {
    const double pitch = std::asin(-world.T_world_body(t).linear()(2, 0));
    low = std::min(low, pitch);
    high = std::max(high, pitch);
  }
  return {low, high};
}

TEST(RenderedWorldScenarios, SlopePitchesTheCart) {
  const auto [low, high] = pitchRange(RenderedWorld(smallDrive(Scenario::slope, 15.0)), 15.0);
  EXPECT_GT(high - low, 0.15);
  const auto [level_low, level_high] = pitchRange(RenderedWorld(smallDrive(Scenario::campus, 15.0)), 15.0);
  EXPECT_LT(level_high - level_low, 0.1);
}

TEST(RenderedWorldScenarios, TunnelEndsInDaylight) {
  const RenderedWorld world(smallDrive(Scenario::tunnel));
  EXPECT_GT(std::log2(world.meanRadiance(9.5) / world.meanRadiance(0.0)), 2.0);
}

TEST(RenderedWorldScenarios, CrowdCoversPartOfTheImage) {
  const std::vector<double> shares = sortedMovingFractions(RenderedWorld(smallDrive(Scenario::crowd)), 36);
  ASSERT_FALSE(shares.empty());
  EXPECT_GT(shares[shares.size() / 2], 0.1);
}

/// Fraction of the left image that changes by more than two grey levels between two instants of the lead-in.
double changeAtStandstill(Scenario scenario) {
  WorldSettings settings = smallDrive(scenario, 4.0);
  settings.noise = 0.0;
  const RenderedWorld world(settings);
  const cv::Mat first = world.image(2, capture::CameraSide::left);
  const cv::Mat second = world.image(14, capture::CameraSide::left);
  cv::Mat difference;
  cv::absdiff(first, second, difference);
  return cv::countNonZero(difference > 2) / static_cast<double>(difference.total());
}

TEST(RenderedWorldScenarios, WindMovesTheFoliage) {
  EXPECT_GT(changeAtStandstill(Scenario::wind), 3.0 * changeAtStandstill(Scenario::campus));
}

/// Pixels of a random image that drops change, 255 or 0.
cv::Mat changedByDrops(std::uint64_t image_seed, std::uint32_t drop_seed) {
  cv::Mat image(105, 170, CV_32FC1);
  cv::RNG(image_seed).fill(image, cv::RNG::UNIFORM, 0.5, 1.5);
  cv::Mat wet = image.clone();
  world::addLensDrops(wet, drop_seed);
  return wet != image;
}

TEST(RenderedWorldScenarios, DropsStayWhereTheyAreInTheImage) {
  const cv::Mat drops = changedByDrops(1, 5);
  const double share = cv::countNonZero(drops) / static_cast<double>(drops.total());
  EXPECT_GT(share, 0.05);
  EXPECT_LT(share, 0.4);
  EXPECT_EQ(cv::norm(drops, changedByDrops(2, 5), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(drops, changedByDrops(1, 6), cv::NORM_INF), 0.0);
}

TEST(RenderedWorldScenarios, GlareSaturatesPartOfTheImage) {
  const RenderedWorld world(smallDrive(Scenario::glare));
  for (const int index : {20, 90, 140}) {
    SCOPED_TRACE(index);
    const cv::Mat image = world.image(index, capture::CameraSide::left);
    const double blinded = cv::countNonZero(image >= 254) / static_cast<double>(image.total());
    EXPECT_GT(blinded, 0.005);
    EXPECT_LT(blinded, 0.15);
    EXPECT_LT(cv::mean(image)[0], 150.0);
  }
}

}  // namespace
}  // namespace cartvo
