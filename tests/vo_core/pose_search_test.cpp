// The pose that landmarks agree on, also where something large drives past.
#include "vo_core/pose_search.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "vo_core/landmark_scene.hpp"

namespace cartvo {
namespace {

using test::kRigCamera;
using test::vector6;

const Eigen::Isometry3d kBefore = test::steadyDrive(0.0);
const Eigen::Isometry3d kNow = test::steadyDrive(2 * test::kFramePeriod);
/// What a bus does meanwhile: a point of it goes where the world would if the camera went this way.
const Eigen::Isometry3d kBusMotion = motionFromVector(vector6(-0.35, 0.0, 0.1, 0.0, 0.0, 0.0));
constexpr int kSeeds = 20;

struct Street {
  int points = 200;
  double bus = 0.0;          ///< share of the points that are on it
  double scattered = 0.0;    ///< share that is anywhere
  double noise = 0.15;       ///< px
  double depth_noise = 1.0;  ///< in units of what the problem assumes
};

/// The first points are the bus's, the next are scattered.
PoseProblem look(const Street& street, std::uint64_t seed) {
  test::Noise random(seed);
  PoseProblem problem;
  problem.camera = kRigCamera;
  problem.hosts = {kBefore, test::steadyDrive(test::kFramePeriod)};
  problem.start = kNow * motionFromVector(vector6(0.02, -0.01, -0.03, 0.003, 0.004, -0.002));
  for (int i = 0; i < street.points; ++i) {
    PosePoint point;
    point.host = i % 2;
    point.bearing =
        bearingOf(kRigCamera, {kRigCamera.width * random.uniform(), kRigCamera.height * random.uniform()});
    point.inverse_depth = 1.0 / 30.0 + 0.2 * random.uniform();
    point.inverse_depth_deviation = 0.003;
    const double believed =
        point.inverse_depth + street.depth_noise * point.inverse_depth_deviation * random.gaussian();
    const bool on_bus = i < street.bus * street.points;
    const Eigen::Isometry3d T_world_camera = on_bus ? Eigen::Isometry3d(kNow * kBusMotion) : kNow;
    const Eigen::Isometry3d T_camera_host = T_world_camera.inverse() * problem.hosts[point.host];
    point.left = projectLandmark(kRigCamera, T_camera_host, point.bearing, point.inverse_depth).pixel;
    point.inverse_depth = believed;
    for (int axis = 0; axis < 2; ++axis)
      point.left[axis] += street.noise * random.gaussian();
    if (!on_bus && i < (street.bus + street.scattered) * street.points)
      point.left = {kRigCamera.width * random.uniform(), kRigCamera.height * random.uniform()};
    problem.points.push_back(point);
  }
  return problem;
}

void allowLittleChange(PoseProblem& problem) {
  problem.admissible_change = vector6(0.1, 0.1, 0.1, 0.03, 0.03, 0.03);
}

std::optional<FoundPose> search(PoseProblem& problem, std::uint64_t seed = 1,
                                const PoseSearchSettings& settings = {}) {
  SubsetRandom random(seed);
  return PoseFinder().find(problem, settings, random);
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

TEST(PoseSearch, FindsThePoseExactlyWithoutNoise) {
  PoseProblem problem = look({.noise = 0.0, .depth_noise = 0.0}, 1);
  const auto found = search(problem);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(vectorFromMotion(kNow.inverse() * found->T_world_camera).norm(), 1e-6);
  EXPECT_EQ(found->inliers, 200);
}

TEST(PoseSearch, FindsThePoseAmongScatteredMatches) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = look({.scattered = 0.45}, seed);
    expectPose(search(problem), kNow, seed);
    EXPECT_LE(inliersAmong(problem, 0, 90), 5);
    EXPECT_GE(inliersAmong(problem, 90, 200), 105);
  }
}

TEST(PoseSearch, IsNotTakenAlongByABus) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = look({.bus = 0.45}, seed);
    allowLittleChange(problem);
    const auto found = search(problem);
    expectPose(found, kNow, seed);
    EXPECT_LE(inliersAmong(problem, 0, 90), 15) << seed;  // what is far away hardly moves
    EXPECT_GE(inliersAmong(problem, 90, 200), 105) << seed;
    EXPECT_NEAR(found->share, found->inliers / 200.0, 1e-9);
  }
}

TEST(PoseSearch, IsNotTakenAlongByABusThatFillsMostOfTheView) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = look({.bus = 0.6}, seed);
    allowLittleChange(problem);
    expectPose(search(problem), kNow, seed);
  }
}

TEST(PoseSearch, WithoutAPredictionTheMajorityWins) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem few = look({.bus = 0.4}, seed), most = look({.bus = 0.6}, seed);
    expectPose(search(few), kNow, seed);
    expectPose(search(most), kNow * kBusMotion, seed);
  }
}

TEST(PoseSearch, TheMajorityIsOneOfTrust) {
  PoseProblem problem = look({.bus = 0.6}, 1);
  for (int i = 0; i < 120; ++i)
    problem.points[i].weight = 0.3;
  const auto found = search(problem);
  expectPose(found, kNow, 1);
  EXPECT_GT(found->share, 0.6);  // 80 points of a weight of 1, 120 of 0.3
}

TEST(PoseSearch, NeverLeavesWhatIsAdmissible) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PoseProblem problem = look({.bus = 1.0}, seed);  // nothing else to be seen
    allowLittleChange(problem);
    const auto found = search(problem);
    ASSERT_TRUE(found.has_value());
    const Vector6d change = vectorFromMotion(problem.start.inverse() * found->T_world_camera);
    EXPECT_TRUE((change.cwiseAbs().array() <= problem.admissible_change->array()).all()) << seed;
    EXPECT_LT(found->share, 0.5) << seed;
  }
}

TEST(PoseSearch, TooFewPointsGiveNothing) {
  PoseProblem problem = look({}, 1);
  problem.points.resize(4);
  EXPECT_FALSE(search(problem).has_value());
  problem.points.clear();
  EXPECT_FALSE(search(problem).has_value());
}

TEST(PoseSearch, TheSameSeedGivesTheSameBits) {
  PoseProblem problem = look({.bus = 0.3, .scattered = 0.2}, 1);
  PoseProblem same = problem;
  const auto one = search(problem, 7);
  const auto two = search(same, 7);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->T_world_camera.matrix(), two->T_world_camera.matrix());
  for (std::size_t i = 0; i < same.points.size(); ++i)
    EXPECT_EQ(problem.points[i].inlier, same.points[i].inlier);
}

TEST(PoseSearch, ErrorsAreInStandardDeviationsTheDepthsIncluded) {
  // The mean square of two coordinates is chi-squared with two degrees of freedom, over two.
  for (const double gate : {1.0, 1.5, 2.0}) {
    PoseProblem problem = look({.points = 1000}, 1);
    const auto found = search(problem, 1, {.gate = gate});
    ASSERT_TRUE(found.has_value()) << gate;
    EXPECT_NEAR(found->inliers / 1000.0, 1.0 - std::exp(-gate * gate), 0.04) << gate;
  }
}

TEST(PoseSearch, APointBehindTheCameraIsNotExplained) {
  PoseProblem problem = look({}, 1);
  problem.points.front().bearing = {0.0, 0.0, -1.0};
  const auto found = search(problem);
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(problem.points.front().inlier);
  EXPECT_GT(found->inliers, 190);
}

}  // namespace
}  // namespace cartvo
