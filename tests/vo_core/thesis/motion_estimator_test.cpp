// Tests of Horn's method, the median pose, the weights (4.16), and all of them on points with noise and
// outliers.
#include "vo_core/thesis/motion_estimator.hpp"

#include <gtest/gtest.h>

#include "support/vo_core/point_scene.hpp"
#include "vo_core/thesis/absolute_orientation.hpp"
#include "vo_core/thesis/median_pose.hpp"
#include "vo_core/thesis/prediction_error.hpp"

namespace cartvo::vo {
namespace {

double difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return vectorFromMotion(a.inverse() * b).norm();
}

std::vector<PointPair> exactPairs(const Eigen::Isometry3d& T) {
  test::Noise noise(4);
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& point : test::scatter(20, noise))
    pairs.push_back({point, T * point, 1.0});
  return pairs;
}

TEST(AbsoluteOrientation, RecoversExactMotions) {
  for (const double angle : {0.0, 0.01, 1.0, 3.1}) {
    Vector6d vector;
    vector << 1.0, -2.0, 0.5, angle * Eigen::Vector3d(0.6, 0.0, -0.8);
    const Eigen::Isometry3d T = motionFromVector(vector);
    const auto estimate = absoluteOrientation(exactPairs(T));
    ASSERT_TRUE(estimate.has_value());
    EXPECT_LT(difference(*estimate, T), 1e-9) << angle;
  }
}

TEST(AbsoluteOrientation, IgnoresPairsOfZeroWeight) {
  auto pairs = exactPairs(test::forwardMotion());
  pairs[3].to += Eigen::Vector3d(5, 5, 5);
  pairs[3].weight = 0.0;
  EXPECT_LT(difference(*absoluteOrientation(pairs), test::forwardMotion()), 1e-9);
}

TEST(AbsoluteOrientation, ReturnsARotationForMirroredClouds) {
  auto pairs = exactPairs(Eigen::Isometry3d::Identity());
  for (PointPair& pair : pairs)
    pair.to.x() = -pair.to.x();
  const auto estimate = absoluteOrientation(pairs);
  if (estimate) {
    EXPECT_NEAR(estimate->linear().determinant(), 1.0, 1e-9);
  }
}

TEST(AbsoluteOrientation, RejectsPointsOnALineAndTooFewPoints) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < 10; ++i)
    pairs.push_back({Eigen::Vector3d(i, 2 * i, 5), Eigen::Vector3d(i, 2 * i, 5), 1.0});
  EXPECT_FALSE(absoluteOrientation(pairs).has_value());
  pairs.resize(2);
  EXPECT_FALSE(absoluteOrientation(pairs).has_value());
}

TEST(MedianPose, IsNotMovedByAMinorityOfWrongPoses) {
  const Eigen::Isometry3d T = test::forwardMotion();
  std::vector<Eigen::Isometry3d> poses(11, T);
  for (int i = 0; i < 5; ++i)
    poses[2 * i] = motionFromVector(Vector6d::Constant(0.3 + 0.1 * i));
  EXPECT_LT(difference(medianPose(poses), T), 1e-9);
}

TEST(ErrorWeight, FallsAsOneOverTheErrorAndEndsAtTheRadius) {
  EXPECT_DOUBLE_EQ(errorWeight(2.0, 3.0), 0.5);
  EXPECT_DOUBLE_EQ(errorWeight(2.9, 3.0), 1.0 / 2.9);
  EXPECT_EQ(errorWeight(3.0, 3.0), 0.0);
  EXPECT_EQ(errorWeight(1e9, 3.0), 0.0);
  EXPECT_EQ(errorWeight(std::nan(""), 3.0), 0.0);
  EXPECT_DOUBLE_EQ(errorWeight(0.0, 3.0), 1.0);
}

std::vector<PointMatch> noisyMatches(int count, double outliers, std::uint64_t seed) {
  test::Noise noise(seed);
  const Eigen::Isometry3d T_current_reference = test::forwardMotion().inverse();
  // The outliers move together, as on a bus: the hardest kind.
  const Eigen::Isometry3d T_bus = motionFromVector((Vector6d() << 0.5, 0.0, 0.3, 0, 0, 0).finished());
  std::vector<PointMatch> matches;
  for (const Eigen::Vector3d& point : test::scatter(count, noise)) {
    const bool moves = noise.uniform() < outliers;
    const Eigen::Vector3d now = T_current_reference * (moves ? T_bus * point : point);
    const Eigen::Vector3d reference = test::measured(point, noise);
    const Eigen::Vector3d current = test::measured(now, noise);
    matches.push_back({reference, current, test::covarianceOf(reference), test::covarianceOf(current), 1.0});
  }
  return matches;
}

TEST(MotionEstimator, FindsTheMotionOfNoisyPoints) {
  SubsetRandom random(1);
  const auto motion = estimateMotion(noisyMatches(400, 0.0, 2), MotionSettings{}, random);
  ASSERT_TRUE(motion.has_value());
  const Vector6d error = vectorFromMotion(motion->T_reference_current.inverse() * test::forwardMotion());
  EXPECT_LT(error.head<3>().norm(), 0.06);
  EXPECT_LT(error.tail<3>().norm(), 0.006);
  EXPECT_GT(motion->inliers, 360);
}

TEST(MotionEstimator, ToleratesFortyPercentThatMoveTogether) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SubsetRandom random(seed);
    const auto motion = estimateMotion(noisyMatches(400, 0.4, seed), MotionSettings{}, random);
    ASSERT_TRUE(motion.has_value());
    const Vector6d error = vectorFromMotion(motion->T_reference_current.inverse() * test::forwardMotion());
    EXPECT_LT(error.head<3>().norm(), 0.12) << "seed " << seed;
    EXPECT_LT(error.tail<3>().norm(), 0.012) << "seed " << seed;
  }
}

TEST(MotionEstimator, GivesTheSameMotionForTheSameSeed) {
  SubsetRandom first(3);
  SubsetRandom second(3);
  const auto matches = noisyMatches(200, 0.2, 7);
  EXPECT_EQ(estimateMotion(matches, MotionSettings{}, first)->T_reference_current.matrix(),
            estimateMotion(matches, MotionSettings{}, second)->T_reference_current.matrix());
}

TEST(MotionEstimator, RejectsTooFewOrDegeneratePoints) {
  SubsetRandom random(1);
  EXPECT_FALSE(estimateMotion({}, MotionSettings{}, random).has_value());
  const PointMatch same{
      {0, 0, 5}, {0, 0, 5}, test::covarianceOf({0, 0, 5}), test::covarianceOf({0, 0, 5}), 1.0};
  EXPECT_FALSE(estimateMotion(std::vector<PointMatch>(50, same), MotionSettings{}, random).has_value());
}

}  // namespace
}  // namespace cartvo::vo
