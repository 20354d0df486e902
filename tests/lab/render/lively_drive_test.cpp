// Holds the figures of lively drives, their smoothness, and the start of the pictures within a drive.
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "common/units.hpp"
#include "lab/render/motion/drive.hpp"
#include "lab/render/rendered_world.hpp"
#include "lab/render/scenario_traits.hpp"
#include "lab/render/scene/campus.hpp"
#include "lab/render/scene/steps.hpp"

namespace cartvo {
namespace {

using world::RenderedWorld;
using world::Scenario;
using world::WorldSettings;

constexpr double kPeriod = 1.0 / 18.0;  // s, of the figures

WorldSettings drive(Scenario scenario, double liveliness, double seconds = 20.0) {
  WorldSettings settings;
  settings.scenario = scenario;
  settings.seed = 4;
  settings.seconds = seconds;
  settings.liveliness = liveliness;
  settings.image_size = cv::Size(170, 105);
  settings.focal_length = 120.0;
  return settings;
}

/// Differences of successive vectors over the period.
std::vector<Eigen::Vector3d> derivative(const std::vector<Eigen::Vector3d>& values) {
  std::vector<Eigen::Vector3d> differences;
  for (std::size_t i = 1; i < values.size(); ++i)
    differences.emplace_back((values[i] - values[i - 1]) / kPeriod);
  return differences;
}

Eigen::Array3d rms(const std::vector<Eigen::Vector3d>& values) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const Eigen::Vector3d& value : values)
    sum += value.array().square();
  return (sum / static_cast<double>(values.size())).sqrt();
}

/// Root mean squares of the left camera's motion in its own axes: right, down, forward.
struct Figures {
  Eigen::Array3d acceleration;          ///< m/s^2
  Eigen::Array3d jerk;                  ///< m/s^3
  Eigen::Array3d rate;                  ///< deg/s, about those axes: pitch, yaw, roll
  Eigen::Array3d angular_acceleration;  ///< deg/s^2
};

Figures figuresOf(const WorldSettings& settings) {
  const RenderedWorld world(settings);
  std::vector<Eigen::Isometry3d> poses;
  for (const StampedPose& stamped : world.truth())
    poses.push_back(stamped.pose * world.rig().T_body_camera);
  std::vector<Eigen::Vector3d> velocity, rate;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Isometry3d motion = poses[i - 1].inverse() * poses[i];
    const Eigen::AngleAxisd turn(motion.linear());
    velocity.emplace_back(motion.translation() / kPeriod);
    rate.emplace_back(turn.angle() / kRadiansPerDegree / kPeriod * turn.axis());
  }
  return {rms(derivative(velocity)), rms(derivative(derivative(velocity))), rms(rate), rms(derivative(rate))};
}

void expectWithin(const char* what, const Eigen::Array3d& figures, double least, double most) {
  std::cout << what << ": " << figures.transpose() << "\n";
  EXPECT_GE(figures.minCoeff(), least) << what;
  EXPECT_LE(figures.maxCoeff(), most) << what;
}

TEST(LivelyDrive, HasTheFiguresOfAGolfCart) {
  for (const Scenario scenario : {Scenario::turns, Scenario::campus, Scenario::traffic}) {
    SCOPED_TRACE(std::string(world::scenarioName(scenario)));
    std::cout << world::scenarioName(scenario) << "\n";
    const Figures figures = figuresOf(drive(scenario, 1.0));
    expectWithin("acceleration, m/s^2", figures.acceleration, 0.9, 3.0);
    expectWithin("jerk, m/s^3", figures.jerk, 15.0, 42.0);
    const Eigen::Array3d& rate = figures.rate;
    std::cout << "rates, deg/s: " << rate.transpose() << "\n";
    EXPECT_GT(rate.y(), 20.0) << "yaw";
    EXPECT_LT(rate.y(), 35.0) << "yaw";
    EXPECT_GT(std::min(rate.x(), rate.z()), 3.0) << "pitch and roll";
    EXPECT_LT(std::max(rate.x(), rate.z()), 7.0) << "pitch and roll";
    expectWithin("angular acceleration, deg/s^2", figures.angular_acceleration, 35.0, 85.0);
  }
}

TEST(LivelyDrive, IsRougherOnRoughGround) {
  const Figures figures = figuresOf(drive(Scenario::bumpy, 1.0));
  expectWithin("acceleration, m/s^2", figures.acceleration, 3.0, 10.0);
  expectWithin("jerk, m/s^3", figures.jerk, 50.0, 150.0);
}

TEST(LivelyDrive, GrowsWithItsLiveliness) {
  std::array<Figures, 3> figures;
  for (std::size_t i = 0; i < figures.size(); ++i)
    figures[i] = figuresOf(drive(Scenario::turns, 0.5 * static_cast<double>(i)));
  for (std::size_t i = 1; i < figures.size(); ++i) {
    EXPECT_GT(figures[i].jerk.minCoeff(), 1.5 * figures[i - 1].jerk.minCoeff());
    EXPECT_GT(figures[i].rate.y(), 1.2 * figures[i - 1].rate.y());
  }
}

// The second derivative changes in a short time by no more than the largest jerk explains: a jump would
// exceed that.
TEST(LivelyDrive, IsTwiceContinuouslyDifferentiable) {
  constexpr double kStep = 2e-4;  // s
  for (const Scenario scenario : {Scenario::turns, Scenario::bumpy, Scenario::stop_and_go}) {
    SCOPED_TRACE(std::string(world::scenarioName(scenario)));
    const double largest_jerk = scenario == Scenario::bumpy ? 1500.0 : 400.0;  // m/s^3
    WorldSettings settings = drive(scenario, 1.0, 5.0);
    settings.start_seconds = 1.0;  // at standstill
    const RenderedWorld world(settings);
    // A point beside and ahead of the camera moves with the camera's rotation, too.
    const Eigen::Vector3d seen = world.rig().T_body_camera * Eigen::Vector3d(1.0, 1.0, 3.0);
    const auto place = [&](double t) -> Eigen::Vector3d { return world.T_world_body(t) * seen; };
    const auto acceleration = [&](double t) -> Eigen::Vector3d {
      return (place(t + kStep) - 2.0 * place(t) + place(t - kStep)) / (kStep * kStep);
    };
    Eigen::Vector3d before = acceleration(0.0);
    double largest = 0.0;
    for (const double t : world::stepsBelow(5.0, kStep, kStep)) {
      const Eigen::Vector3d here = acceleration(t);
      largest = std::max(largest, (here - before).norm());
      before = here;
    }
    EXPECT_LT(largest, largest_jerk * kStep);
    EXPECT_GT(largest, 0.1 * largest_jerk * kStep) << "the bound is too wide to find a jump";
  }
}

TEST(LivelyDrive, StaysInItsLane) {
  constexpr double kHalfWidth = 0.45;  // m, from the middle of the cart to its wheels
  for (const Scenario scenario : {Scenario::hedges, Scenario::turns, Scenario::campus}) {
    SCOPED_TRACE(std::string(world::scenarioName(scenario)));
    const WorldSettings settings = drive(scenario, 1.0, 60.0);
    const world::Path path = world::campusPath(settings);
    const world::Drive lively(path, settings);
    const world::RoadProfile road = world::traitsOf(scenario).road;
    for (const double t : world::stepsBelow(60.0, 0.0, 0.1)) {
      const Eigen::Isometry3d pose = lively.T_map_body(t);
      for (const double axle : {0.0, 1.65}) {
        const world::PathPoint at = path.at(lively.distance(t) + axle);
        const Eigen::Vector2d place = (pose * Eigen::Vector3d(axle, 0.0, 0.0)).head<2>() - at.position;
        const double lateral = place.dot(Eigen::Vector2d(-at.tangent.y(), at.tangent.x()));
        EXPECT_LT(lateral + kHalfWidth, road.left_kerb) << t;
        EXPECT_GT(lateral - kHalfWidth, road.right_kerb) << t;
      }
    }
  }
}

TEST(StartOfPictures, ShiftsTheTruthExactly) {
  for (const double liveliness : {0.0, 1.0}) {
    WorldSettings settings = drive(Scenario::turns, liveliness);
    settings.start_seconds = 0.0;
    const RenderedWorld whole(settings);
    settings.start_seconds = 5.25;
    const RenderedWorld part(settings);
    EXPECT_TRUE(part.truth().front().pose.isApprox(Eigen::Isometry3d::Identity(), 1e-12));
    EXPECT_EQ(part.truth().size(), whole.truth().size());
    const Eigen::Isometry3d T_start_world = whole.T_world_body(5.25).inverse();
    for (const double t : world::stepsBelow(14.0, -0.1, 0.37))
      EXPECT_TRUE(part.T_world_body(t).isApprox(T_start_world * whole.T_world_body(5.25 + t), 1e-10)) << t;
  }
}

TEST(StartOfPictures, ShiftsTheSceneWithItsTraffic) {
  WorldSettings settings = drive(Scenario::traffic, 1.0, 4.0);
  settings.start_seconds = 0.0;
  const RenderedWorld whole(settings);
  settings.start_seconds = 2.5;
  const RenderedWorld part(settings);
  const cv::Mat expected = whole.renderDepth(45 + 9, capture::CameraSide::left).depth;
  const cv::Mat shifted = part.renderDepth(9, capture::CameraSide::left).depth;
  cv::Mat differs = cv::abs(expected - shifted) > 1e-3;
  EXPECT_LT(cv::countNonZero(differs), 20) << "of " << differs.total() << " pixels";
}

TEST(StartOfPictures, IsInMotionUnlessADriveIsCalm) {
  EXPECT_TRUE(RenderedWorld(drive(Scenario::turns, 0.0)).startsAtStandstill());
  WorldSettings settings = drive(Scenario::stop_and_go, 1.0);
  const RenderedWorld lively(settings);
  EXPECT_FALSE(lively.startsAtStandstill());
  EXPECT_GT(lively.T_world_body(0.1).translation().norm(), 0.2) << "above 2 m/s";
  settings.start_seconds = 0.0;
  EXPECT_TRUE(RenderedWorld(settings).startsAtStandstill());
}

TEST(StartOfPictures, IsInTheCacheKeyUnlessItIsTheUsualOne) {
  WorldSettings settings = drive(Scenario::turns, 0.0);
  const std::string usual = RenderedWorld(settings).cacheKey();
  EXPECT_EQ(usual.find("lively"), std::string::npos);
  EXPECT_EQ(usual.find("start"), std::string::npos);
  settings.start_seconds = 0.0;
  EXPECT_EQ(RenderedWorld(settings).cacheKey(), usual);
  std::set<std::string> keys{usual};
  settings.start_seconds = 4.0;
  keys.insert(RenderedWorld(settings).cacheKey());
  settings.liveliness = 1.0;
  keys.insert(RenderedWorld(settings).cacheKey());
  settings.start_seconds.reset();
  keys.insert(RenderedWorld(settings).cacheKey());
  settings.liveliness = 0.5;
  keys.insert(RenderedWorld(settings).cacheKey());
  EXPECT_EQ(keys.size(), 5U);
}

TEST(LivelyDrive, RefusesAMotorwayAndTooMuch) {
  EXPECT_THROW(RenderedWorld{drive(Scenario::motorway, 1.0)}, std::invalid_argument);
  EXPECT_THROW(RenderedWorld{drive(Scenario::turns, 1.5)}, std::invalid_argument);
}

}  // namespace
}  // namespace cartvo
