// Tests of the uncertainty model of motions, term by term.
#include "vo_core/estimation/motion_error.hpp"

#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/estimation/window_uncertainty.hpp"

namespace cartvo::vo {
namespace {

constexpr double kNoRobustWidth = 1e6;  // robust width at which every weight is one

Matrix6d diagonal(double variance) {
  return variance * Matrix6d::Identity();
}

std::vector<WindowFrame> windowOf(const BundleProblem& problem) {
  std::vector<WindowFrame> window;
  for (const TimedPose& pose : problem.poses) {
    WindowFrame& frame = window.emplace_back();
    frame.T_world_camera = pose.T_world_camera;
    frame.dpose_doffset = pose.dpose_doffset;
  }
  return window;
}

struct Adjusted {
  MotionError error;
  Vector6d true_error;  // of the motion between the last two pairs
};

/// Adjusts a simulated window and compares its last motion with the truth.
Adjusted adjustScene(const test::LandmarkScene& scene, const PairInflation& inflation, double delay,
                     std::uint64_t seed) {
  test::LandmarkScene simulated = scene;
  simulated.delay = delay;
  BundleProblem problem = test::simulateProblem(simulated, seed);
  const BundleSettings settings{.iterations = 10, .convergence = 0.0, .robust_width = kNoRobustWidth};
  const BundleResult result = test::adjustBundle(problem, settings);
  EXPECT_TRUE(result.converged);
  std::vector<WindowFrame> window = windowOf(problem);
  // One for the noise of independent measurements; the default accounts for what the windows of a drive
  // share.
  const UncertaintySettings uncertainty{.motion_noise_factor = 1.0};
  Adjusted adjusted{updateUncertainties(problem, result, inflation, uncertainty, window), {}};
  const auto motion = [](const TimedPose& from, const TimedPose& to) {
    return Eigen::Isometry3d(from.T_world_camera.inverse() * to.T_world_camera);
  };
  const std::size_t last = problem.poses.size() - 1;
  const Eigen::Isometry3d truth =
      test::steadyDrive(problem.poses[last - 1].time).inverse() * test::steadyDrive(problem.poses[last].time);
  adjusted.true_error =
      vectorFromMotion(truth.inverse() * motion(problem.poses[last - 1], problem.poses[last]));
  return adjusted;
}

TEST(MotionError, CovarianceIsTheSumOfItsTerms) {
  MotionError error;
  EXPECT_TRUE(error.covariance().isZero());
  error.by_landmarks = diagonal(1.0);
  error.by_scale = diagonal(2.0);
  error.by_rows = diagonal(4.0);
  EXPECT_TRUE(error.covariance().isApprox(diagonal(7.0)));
  error.startup_inflation = 3.0;
  error.codec_inflation = 2.0;
  EXPECT_TRUE(error.covariance().isApprox(diagonal(42.0)))
      << "inflations multiply what is measured in images";
  error.by_standstill = diagonal(0.5);
  error.by_codec_shift = diagonal(0.25);
  EXPECT_TRUE(error.covariance().isApprox(diagonal(42.75))) << "and nothing else";
  error.by_offset = test::vector6(1.0, 0.0, 0.0, 0.0, 0.0, 2.0);
  EXPECT_DOUBLE_EQ(error.covariance()(0, 0), 43.75);
  EXPECT_DOUBLE_EQ(error.covariance()(0, 5), 2.0) << "components err together";
}

TEST(MotionError, MeasuredPartHasNoInflation) {
  MotionError error;
  error.by_landmarks = diagonal(1.0);
  error.by_offset = test::vector6(1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  error.by_scale = error.by_rows = error.by_standstill = error.by_codec_shift = diagonal(100.0);
  error.startup_inflation = error.codec_inflation = 30.0;
  EXPECT_DOUBLE_EQ(error.measured()(0, 0), 2.0);
  EXPECT_DOUBLE_EQ(error.measured()(1, 1), 1.0);
}

TEST(MotionError, LandmarkTermIsTheScatterOfMotions) {
  constexpr int kTrials = 150;
  double nees = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Adjusted adjusted = adjustScene({.free_frames = 2, .noise = 1.0}, {}, 0.0, 9000 + trial);
    nees += adjusted.true_error.dot(adjusted.error.by_landmarks.ldlt().solve(adjusted.true_error)) / 6.0;
  }
  EXPECT_NEAR(nees / kTrials, 1.0, 0.15);
}

TEST(MotionError, LandmarkTermGrowsWithTheOverlapOfPatches) {
  const test::LandmarkScene scene{.free_frames = 2, .noise = 1.0};
  const Matrix6d apart = adjustScene(scene, {}, 0.0, 9001).error.by_landmarks;
  const Matrix6d overlapping = adjustScene(scene, {.overlap = 2.5}, 0.0, 9001).error.by_landmarks;
  EXPECT_TRUE(overlapping.isApprox(2.5 * apart));
}

TEST(MotionError, OffsetTermIsTheErrorOfADelayedRightCamera) {
  constexpr double kDelay = 1e-4;  // s
  const Adjusted adjusted =
      adjustScene({.free_frames = 2, .offset = 0.02}, {.offset_stddev = kDelay}, kDelay, 9002);
  EXPECT_GT(adjusted.true_error.norm(), 1e-6);
  EXPECT_LT((adjusted.true_error - adjusted.error.by_offset).norm(), 0.1 * adjusted.true_error.norm());
}

TEST(MotionError, ScaleTermIsAlongTheMotion) {
  const MotionError error = adjustScene({.free_frames = 2, .noise = 1.0}, {}, 0.0, 9003).error;
  const Eigen::Isometry3d motion = test::steadyDrive(0.0).inverse() * test::steadyDrive(test::kFramePeriod);
  const Eigen::Vector3d along = motion.linear().transpose() * motion.translation().normalized();
  const Eigen::Matrix3d by_scale = error.by_scale.topLeftCorner<3, 3>();
  EXPECT_GT(by_scale.trace(), 0.0);
  EXPECT_NEAR(along.dot(by_scale * along) / by_scale.trace(), 1.0, 1e-2);
  EXPECT_TRUE((error.by_scale.bottomRightCorner<3, 3>().isZero()));
}

TEST(MotionError, CodecInflationIsThatOfThePair) {
  const MotionError error =
      adjustScene({.free_frames = 2, .noise = 1.0}, {.pose_noise_inflation = 4.0}, 0.0, 9004).error;
  EXPECT_DOUBLE_EQ(error.codec_inflation, 4.0);
}

TEST(StartupInflation, FallsUntilTheWindowIsFull) {
  const UncertaintySettings settings{.first_motion_inflation = 8.0};
  EXPECT_DOUBLE_EQ(startupInflation(1, 7, settings), 9.0);
  EXPECT_DOUBLE_EQ(startupInflation(4, 7, settings), 3.0);
  EXPECT_DOUBLE_EQ(startupInflation(7, 7, settings), 1.0);
  EXPECT_DOUBLE_EQ(startupInflation(100, 7, settings), 1.0);
}

}  // namespace
}  // namespace cartvo::vo
