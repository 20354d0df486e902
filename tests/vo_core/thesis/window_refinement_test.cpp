// Tests that the refinement reduces the error of noisy chains and that its covariance is consistent.
#include "vo_core/thesis/window_refinement.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include <gtest/gtest.h>

#include "common/statistics.hpp"
#include "support/vo_core/point_scene.hpp"
#include "vo_core/thesis/motion_estimator.hpp"

namespace cartvo::vo {
namespace {

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
