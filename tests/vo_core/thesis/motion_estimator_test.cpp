// Tests of Horn's method, the median pose, the weights (4.16), and all of them on points with noise and
// outliers.
#include "vo_core/thesis/motion_estimator.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include <gtest/gtest.h>

#include "common/statistics.hpp"
#include "support/vo_core/point_scene.hpp"
#include "vo_core/thesis/absolute_orientation.hpp"
#include "vo_core/thesis/median_pose.hpp"
#include "vo_core/thesis/prediction_error.hpp"
#include "vo_core/thesis/window_refinement.hpp"

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

constexpr double kRadius = 3.5;

/// Features of a scene observed by `frames` frames one motion apart, the last of which is the current one;
/// the poses of the earlier ones are exact.
std::vector<RefinementFeature> seenBy(int frames, int count, std::uint64_t seed) {
  test::Noise noise(seed);
  const Eigen::Isometry3d T = test::forwardMotion();
  Eigen::Isometry3d T_first_current = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < frames; ++i) {
    poses.push_back(T_first_current);
    T_first_current = T_first_current * T;
  }
  std::vector<RefinementFeature> features;
  for (const Eigen::Vector3d& point : test::scatter(count, noise)) {
    RefinementFeature feature;
    feature.current = test::measured(poses.back().inverse() * (point + Eigen::Vector3d(0, 0, 3)), noise);
    feature.current_covariance = test::covarianceOf(feature.current);
    for (int i = 0; i < frames - 1; ++i) {
      const Eigen::Vector3d seen =
          test::measured(poses[i].inverse() * (point + Eigen::Vector3d(0, 0, 3)), noise);
      feature.earlier.push_back(
          {poses[i] * seen, poses[i].linear() * test::covarianceOf(seen) * poses[i].linear().transpose()});
    }
    std::reverse(feature.earlier.begin(), feature.earlier.end());
    feature.cell = static_cast<int>(features.size()) % 60;
    features.push_back(feature);
  }
  return features;
}

Eigen::Isometry3d truth(int frames) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < frames - 1; ++i)
    pose = pose * test::forwardMotion();
  return pose;
}

Vector6d errorOf(const Eigen::Isometry3d& pose, int frames) {
  return vectorFromMotion(pose.inverse() * truth(frames));
}

TEST(WindowRefinement, ReducesTheErrorOfNoisyChains) {
  // Medians: now and then a start is so far off that no refinement corrects it, and would dominate a sum.
  std::vector<double> before, two_frames, five_frames;
  const auto squared = [](const Eigen::Isometry3d& pose) { return errorOf(pose, 5).squaredNorm(); };
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto features = seenBy(5, 150, seed);
    auto last_only = features;
    std::vector<PointMatch> matches;
    for (RefinementFeature& feature : last_only) {
      feature.earlier = {feature.earlier.front()};
      matches.push_back({feature.earlier[0].world, feature.current, feature.earlier[0].covariance,
                         feature.current_covariance, 1.0});
    }
    SubsetRandom random(seed);
    const Eigen::Isometry3d start = estimateMotion(matches, MotionSettings{}, random)->T_reference_current;
    const auto refined = [&start](const std::vector<RefinementFeature>& seen) {
      return refinePose(start, seen, 1.0, kRadius, RefinementSettings{}).T_world_camera;
    };
    before.push_back(squared(start));
    two_frames.push_back(squared(refined(last_only)));
    five_frames.push_back(squared(refined(features)));
  }
  EXPECT_LT(median(two_frames), 0.05 * median(before));
  EXPECT_LT(median(five_frames), 0.9 * median(two_frames));
}

/// Mean normalised estimation error squared (NEES) over many trials; 6 if the covariance is consistent.
double meanNees(int frames, double noise_scale) {
  constexpr int kTrials = 200;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto features = seenBy(frames, 150, 100 + trial);
    for (RefinementFeature& feature : features) {  // wrongly assumed noise must not matter
      feature.current_covariance *= noise_scale * noise_scale;
      for (EarlierPoint& earlier : feature.earlier)
        earlier.covariance *= noise_scale * noise_scale;
    }
    const RefinedPose refined = refinePose(truth(frames), features, 1.0, kRadius, RefinementSettings{});
    EXPECT_TRUE(refined.converged);
    const Vector6d error = errorOf(refined.T_world_camera, frames);
    sum += error.dot(refined.covariance.ldlt().solve(error));
  }
  return sum / kTrials;
}

TEST(WindowRefinement, CovarianceAgreesWithTheErrors) {
  // The mean of 200 chi-squared numbers of six degrees lies within 5.5 and 6.5 in 95 % of all cases.
  EXPECT_NEAR(meanNees(2, 1.0), 6.0, 0.9);
  // Triangulated points are biased a little outwards, which weighs more as more frames lower the variance.
  EXPECT_NEAR(meanNees(5, 1.0), 6.0, 2.5);
}

TEST(WindowRefinement, CovarianceIsIndependentOfTheAssumedNoise) {
  EXPECT_NEAR(meanNees(2, 1.6), 6.0, 1.2);
}

TEST(WindowRefinement, CovarianceCountsCorrelatedNeighboursOnce) {
  const auto features = seenBy(2, 150, 1);
  std::vector<RefinementFeature> crowd;  // each feature four times, in the same cell
  for (int copy = 0; copy < 4; ++copy)
    crowd.insert(crowd.end(), features.begin(), features.end());
  const RefinedPose one = refinePose(truth(2), features, 1.0, kRadius, RefinementSettings{});
  const RefinedPose many = refinePose(truth(2), crowd, 1.0, kRadius, RefinementSettings{});
  ASSERT_TRUE(one.converged && many.converged);
  EXPECT_NEAR(many.covariance.trace() / one.covariance.trace(), 1.0, 0.05);
}

TEST(WindowRefinement, DoesNotConvergeOnAnUndeterminedPose) {
  auto features = seenBy(2, 150, 1);
  features.resize(2);
  EXPECT_FALSE(refinePose(truth(2), features, 1.0, kRadius, RefinementSettings{}).converged);
  EXPECT_FALSE(refinePose(truth(2), {}, 1.0, kRadius, RefinementSettings{}).converged);
}

TEST(WindowRefinement, CovarianceOfIdenticalPointsIsInvertible) {
  auto features = seenBy(2, 100, 1);
  for (RefinementFeature& feature : features)
    feature.current = feature.earlier[0].world;
  const RefinedPose refined =
      refinePose(Eigen::Isometry3d::Identity(), features, 1.0, kRadius, RefinementSettings{});
  EXPECT_TRUE(refined.converged);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(refined.covariance).eigenvalues().minCoeff(), 0.0);
}

}  // namespace

}  // namespace cartvo::vo
