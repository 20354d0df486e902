// Tests of the pose search among outliers and next to a large moving vehicle.
#include "vo_core/estimation/pose_search.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/geometry/reprojection.hpp"

namespace cartvo::vo {
namespace {

using test::kRigCamera;
using test::vector6;

const Eigen::Isometry3d kBefore = test::steadyDrive(0.0);
const Eigen::Isometry3d kNow = test::steadyDrive(2 * test::kFramePeriod);
/// Apparent camera motion of a bus: its points move like static ones if the camera moved this way.
const Eigen::Isometry3d kBusMotion = motionFromVector(vector6(-0.35, 0.0, 0.1, 0.0, 0.0, 0.0));
constexpr int kSeeds = 20;

struct Street {
  int points = 200;
  double bus = 0.0;          ///< fraction of points on a bus
  double scattered = 0.0;    ///< fraction of points with random positions
  double far = 0.0;          ///< fraction of points at infinity, which fit the bus and the street
  double noise = 0.15;       ///< px
  double depth_noise = 1.0;  ///< in units of the assumed noise
};

/// Simulates a problem. The first points are on the bus, the next ones are scattered, the last ones far.
PoseProblem simulateStreet(const Street& street, std::uint64_t seed) {
  test::Noise random(seed);
  PoseProblem problem;
  problem.camera = kRigCamera;
  problem.noise.fill(0.15);
  problem.anchors = {kBefore, test::steadyDrive(test::kFramePeriod)};
  problem.start = kNow * motionFromVector(vector6(0.02, -0.01, -0.03, 0.003, 0.004, -0.002));
  problem.expected = problem.start;
  for (int i = 0; i < street.points; ++i) {
    PosePoint point;
    point.anchor = i % 2;
    point.bearing =
        bearingOf(kRigCamera, {kRigCamera.width * random.uniform(), kRigCamera.height * random.uniform()});
    point.inverse_depth = 1.0 / 30.0 + 0.2 * random.uniform();
    point.inverse_depth_stddev = 0.003;
    if (i >= (1.0 - street.far) * street.points) point.inverse_depth = 0.0;
    const double assumed_inverse_depth =
        point.inverse_depth + street.depth_noise * point.inverse_depth_stddev * random.gaussian();
    const bool on_bus = i < street.bus * street.points;
    const Eigen::Isometry3d T_world_camera = on_bus ? Eigen::Isometry3d(kNow * kBusMotion) : kNow;
    const Eigen::Isometry3d T_camera_anchor = T_world_camera.inverse() * problem.anchors[point.anchor];
    point.left = projectLandmark(kRigCamera, T_camera_anchor, point.bearing, point.inverse_depth).pixel;
    point.inverse_depth = assumed_inverse_depth;
    for (int axis = 0; axis < 2; ++axis)
      point.left[axis] += street.noise * random.gaussian();
    if (!on_bus && i < (street.bus + street.scattered) * street.points)
      point.left = {kRigCamera.width * random.uniform(), kRigCamera.height * random.uniform()};
    problem.points.push_back(point);
  }
  return problem;
}

void setMotionGate(PoseProblem& problem) {
  problem.admissible_change = vector6(0.1, 0.1, 0.1, 0.03, 0.03, 0.03);
}

std::optional<FoundPose> search(PoseProblem& problem, std::uint64_t seed = 1,
                                const PoseSearchSettings& settings = {}) {
  SubsetRandom random(seed);
  return PoseFinder().find(problem, settings, random);
}

std::optional<AlternativePose> findAlternative(const PoseProblem& searched) {
  SubsetRandom random(1);
  return PoseFinder().findAlternative(searched, {}, 15, random);
}

void expectPose(const std::optional<FoundPose>& found, const Eigen::Isometry3d& expected, int seed) {
  ASSERT_TRUE(found.has_value()) << seed;
  const Vector6d error = vectorFromMotion(expected.inverse() * found->T_world_camera);
  EXPECT_LT(error.head<3>().norm(), 0.01) << seed;
  EXPECT_LT(error.tail<3>().norm(), 0.001) << seed;
}

int inliersAmong(const PoseProblem& searched, int begin, int end) {
  return static_cast<int>(std::count_if(searched.points.begin() + begin, searched.points.begin() + end,
                                        [](const PosePoint& point) { return point.inlier; }));
}

TEST(PoseSearch, RecoversThePoseWithoutNoise) {
  PoseProblem problem = simulateStreet({.noise = 0.0, .depth_noise = 0.0}, 1);
  const auto found = search(problem);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(vectorFromMotion(kNow.inverse() * found->T_world_camera).norm(), 1e-6);
  EXPECT_EQ(found->inliers, 200);
}

TEST(PoseSearch, FindsThePoseAmongScatteredMatches) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = simulateStreet({.scattered = 0.45}, seed);
    expectPose(search(problem), kNow, seed);
    EXPECT_LE(inliersAmong(problem, 0, 90), 5);
    EXPECT_GE(inliersAmong(problem, 90, 200), 105);
  }
}

TEST(PoseSearch, IgnoresABus) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = simulateStreet({.bus = 0.45}, seed);
    setMotionGate(problem);
    const auto found = search(problem);
    expectPose(found, kNow, seed);
    EXPECT_LE(inliersAmong(problem, 0, 90), 15) << seed;  // distant bus points hardly move
    EXPECT_GE(inliersAmong(problem, 90, 200), 105) << seed;
    EXPECT_NEAR(found->inlier_ratio, found->inliers / 200.0, 1e-9);
  }
}

TEST(PoseSearch, IgnoresABusThatFillsMostOfTheView) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = simulateStreet({.bus = 0.6}, seed);
    setMotionGate(problem);
    expectPose(search(problem), kNow, seed);
  }
}

/// Simulates a cart that stands still among plants: a third of the points stands, too; the others sway to one
/// side by up to `sway` (m).
PoseProblem simulateWind(double sway, std::uint64_t seed) {
  test::Noise random(seed);
  PoseProblem problem = simulateStreet({.noise = 0.05, .depth_noise = 0.0}, seed);
  problem.start = problem.expected =
      kNow * motionFromVector(vector6(-0.003, 0.001, 0.002, 0.0002, 0.0001, 0.0));
  for (std::size_t i = problem.points.size() / 3; i < problem.points.size(); ++i) {
    PosePoint& point = problem.points[i];
    const double swayed = sway * random.uniform();
    const Eigen::Isometry3d apparent = kNow * motionFromVector(vector6(swayed, 0.0, -swayed, 0.0, 0.0, 0.0));
    const Eigen::Isometry3d T_camera_anchor = apparent.inverse() * problem.anchors[point.anchor];
    point.left = projectLandmark(kRigCamera, T_camera_anchor, point.bearing, point.inverse_depth).pixel;
  }
  return problem;
}

TEST(PoseSearch, FollowsWhatStandsAmongPlantsThatSway) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = simulateWind(0.02, seed);
    const auto found = search(problem, seed);
    ASSERT_TRUE(found.has_value()) << seed;
    EXPECT_LT((kNow.inverse() * found->T_world_camera).translation().norm(), 0.005) << seed;
  }
}

TEST(PoseSearch, FindsTheMajorityWithoutAMotionGate) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem few = simulateStreet({.bus = 0.4}, seed), most = simulateStreet({.bus = 0.6}, seed);
    expectPose(search(few), kNow, seed);
    expectPose(search(most), kNow * kBusMotion, seed);
  }
}

TEST(PoseSearch, WeightsPointsByTrust) {
  PoseProblem problem = simulateStreet({.bus = 0.6}, 1);
  for (int i = 0; i < 120; ++i)
    problem.points[i].weight = 0.3;
  const auto found = search(problem);
  expectPose(found, kNow, 1);
  EXPECT_GT(found->inlier_ratio, 0.6);  // 80 points with weight 1, 120 with 0.3
}

TEST(PoseSearch, StaysWithinTheMotionGate) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = simulateStreet({.bus = 1.0}, seed);  // no static points
    setMotionGate(problem);
    const auto found = search(problem);
    ASSERT_TRUE(found.has_value());
    const Vector6d change = vectorFromMotion(problem.start.inverse() * found->T_world_camera);
    EXPECT_TRUE((change.cwiseAbs().array() <= problem.admissible_change->array()).all()) << seed;
    EXPECT_LT(found->inlier_ratio, 0.5) << seed;
  }
}

TEST(PoseSearch, FailsWithTooFewPoints) {
  PoseProblem problem = simulateStreet({}, 1);
  problem.points.resize(4);
  EXPECT_FALSE(search(problem).has_value());
  problem.points.clear();
  EXPECT_FALSE(search(problem).has_value());
}

TEST(PoseSearch, IsDeterministicForASeed) {
  PoseProblem problem = simulateStreet({.bus = 0.3, .scattered = 0.2}, 1);
  PoseProblem same = problem;
  const auto one = search(problem, 7);
  const auto two = search(same, 7);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->T_world_camera.matrix(), two->T_world_camera.matrix());
  for (std::size_t i = 0; i < same.points.size(); ++i)
    EXPECT_EQ(problem.points[i].inlier, same.points[i].inlier);
}

TEST(PoseSearch, NormalisesErrorsByPixelAndDepthNoise) {
  // The mean square of two coordinates is chi-squared with two degrees of freedom, over two.
  for (const double gate : {1.0, 1.5, 2.0}) {
    PoseProblem problem = simulateStreet({.points = 1000}, 1);
    const auto found = search(problem, 1, {.gate = gate});
    ASSERT_TRUE(found.has_value()) << gate;
    EXPECT_NEAR(found->inliers / 1000.0, 1.0 - std::exp(-gate * gate), 0.04) << gate;
  }
}

TEST(PoseSearch, MarksOutliersBeyondTwiceTheGate) {
  PoseProblem problem = simulateStreet({.noise = 0.0, .depth_noise = 0.0}, 1);
  const double gate = PoseSearchSettings().gate;
  // The error is the RMS of two coordinates.
  const double stddev = std::sqrt(2.0) * problem.noise[0];
  const auto move = [&](int index, double errors) {
    problem.points[index].level = 0;
    problem.points[index].inverse_depth_stddev = 0.0;
    problem.points[index].left.y() += errors * stddev;
  };
  move(0, 0.9 * gate);
  move(1, 1.5 * gate);
  move(2, 2.2 * gate);
  ASSERT_TRUE(search(problem).has_value());
  const auto expect_flags = [&](int index, bool inlier, bool outlier) {
    EXPECT_EQ(problem.points[index].inlier, inlier) << index;
    EXPECT_EQ(problem.points[index].outlier, outlier) << index;
  };
  expect_flags(0, true, false);
  expect_flags(1, false, false);
  expect_flags(2, false, true);
}

/// 60 points are on a bus, 80 on the street and 60 far; the street keeps its place in the image.
TEST(PoseSearch, AlternativeIsComparedWithoutThePointsThatFitBoth) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = simulateStreet({.bus = 0.3, .far = 0.3}, seed);
    for (int i = 60; i < 140; ++i)
      problem.points[i].still = true;
    expectPose(search(problem), kNow, seed);
    const auto other = findAlternative(problem);
    ASSERT_TRUE(other.has_value()) << seed;
    const Eigen::Isometry3d error = (kNow * kBusMotion).inverse() * other->T_world_camera;
    EXPECT_LT(error.translation().norm(), 0.03) << seed;
    EXPECT_NEAR(other->weight, 60.0, 5.0) << seed;
    EXPECT_NEAR(other->weight_of_found, 80.0, 5.0) << seed;
    EXPECT_NEAR(other->still_of_found, 80.0, 5.0) << seed;
  }
}

TEST(PoseSearch, ScatteredMatchesHaveNoAlternative) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = simulateStreet({.scattered = 0.45}, seed);
    ASSERT_TRUE(search(problem).has_value()) << seed;
    EXPECT_FALSE(findAlternative(problem).has_value()) << seed;
  }
}

TEST(PoseSearch, AlternativeIsWithinTheMotionGate) {
  PoseProblem problem = simulateStreet({.bus = 0.4}, 1);
  setMotionGate(problem);
  ASSERT_TRUE(search(problem).has_value());
  EXPECT_FALSE(findAlternative(problem).has_value());
}

TEST(PoseSearch, RejectsPointBehindTheCamera) {
  PoseProblem problem = simulateStreet({}, 1);
  problem.points.front().bearing = {0.0, 0.0, -1.0};
  const auto found = search(problem);
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(problem.points.front().inlier);
  EXPECT_GT(found->inliers, 190);
}

}  // namespace
}  // namespace cartvo::vo
