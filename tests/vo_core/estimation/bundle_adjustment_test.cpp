// Tests of the bundle adjustment on simulated landmarks and poses.
#include "vo_core/estimation/bundle_adjustment.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"

namespace cartvo::vo {
namespace {

using test::LandmarkScene;

constexpr double kOffsets[] = {-0.02, 0.0, 0.02};  // s
constexpr double kNoRobustWidth = 1e6;             // robust width at which every weight is one

TEST(BundleAdjustment, RecoversPosesAndDepthsWithoutNoise) {
  const BundleSettings settings{.iterations = 20, .convergence = 0.0};
  for (const int free_frames : {1, 3}) {
    for (const double offset : kOffsets) {
      const LandmarkScene scene{.free_frames = free_frames, .offset = offset};
      const BundleProblem truth = test::simulateProblem(scene, 1);
      BundleProblem problem = truth;
      test::disturb(problem);
      const BundleResult result = test::adjustBundle(problem, settings);
      ASSERT_TRUE(result.converged);
      EXPECT_LT(test::poseErrors(problem).norm(), 1e-6) << free_frames << " free, " << offset << " s";
      for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
        EXPECT_NEAR(problem.landmarks[i].inverse_depth, truth.landmarks[i].inverse_depth, 1e-6);
        EXPECT_LT(problem.landmarks[i].error, 1e-3);
      }
    }
  }
}

TEST(BundleAdjustment, ConvergesQuadratically) {
  // One step from nearby reaches the truth only with exact derivatives.
  constexpr double kNearby = 1e-4;
  for (const int free_frames : {1, 3, 6}) {
    for (const double offset : kOffsets) {
      BundleProblem problem = test::simulateProblem({.free_frames = free_frames, .offset = offset}, 1);
      test::disturb(problem, kNearby);
      const double before = test::poseErrors(problem).norm();
      ASSERT_TRUE(test::adjustBundle(problem, {.iterations = 1, .robust_width = kNoRobustWidth}).converged);
      EXPECT_LT(test::poseErrors(problem).norm(), 1e-4 * before)
          << free_frames << " free, " << offset << " s";
    }
  }
}

TEST(BundleAdjustment, IgnoringTheTimeOffsetBiasesThePose) {
  // Shows that the tests with an offset would fail if it were ignored.
  BundleProblem problem = test::simulateProblem({.offset = 0.02}, 1);
  for (TimedPose& pose : problem.poses)
    pose.offset = 0.0;
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  EXPECT_GT(test::poseErrors(problem).head<3>().norm(), 0.001);
}

/// Pose error if every other landmark's positions have twenty times the noise, which relative_noise states or
/// not.
double errorAmongNoisyLandmarks(bool noise_stated) {
  constexpr double kRelative = 20.0;
  double squares = 0.0;
  for (int seed = 1; seed <= 5; ++seed) {
    BundleProblem problem = test::simulateProblem({.noise = 0.3}, seed);
    const BundleProblem exact = test::simulateProblem({}, seed);
    for (std::size_t i = 0; i < problem.landmarks.size(); i += 2) {
      auto& observations = problem.landmarks[i].observations;
      for (std::size_t k = 1; k < observations.size(); ++k) {  // the anchor position defines the landmark
        const Eigen::Vector2d& truth = exact.landmarks[i].observations[k].left;
        const Eigen::Vector2d added = (kRelative - 1.0) * (observations[k].left - truth);
        observations[k].left += added;
        observations[k].right += added;  // the disparity stays as good as it was
        if (noise_stated) observations[k].relative_noise.setConstant(kRelative);
      }
    }
    EXPECT_TRUE(
        test::adjustBundle(problem, {.iterations = 10, .convergence = 0.0, .robust_width = kNoRobustWidth})
            .converged);
    squares += test::poseErrors(problem).squaredNorm();
  }
  return std::sqrt(squares);
}

TEST(BundleAdjustment, WeightsPositionsByTheirNoise) {
  EXPECT_LT(3.0 * errorAmongNoisyLandmarks(true), errorAmongNoisyLandmarks(false));
}

TEST(BundleAdjustment, KeepsFixedPoses) {
  BundleProblem problem = test::simulateProblem({.free_frames = 3, .noise = 1.0}, 1);
  const TimedPoses before = problem.poses;
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(problem.poses[i].T_world_camera.matrix() == before[i].T_world_camera.matrix(), i < 4) << i;
}

/// Problem whose right cameras were exposed later than its offsets say.
BundleProblem withDelay(const LandmarkScene& scene, double delay) {
  BundleProblem problem = test::simulateProblem(scene, 1);
  for (TimedPose& pose : problem.poses)
    pose.offset -= delay;
  return problem;
}

TEST(BundleAdjustment, ReportsSensitivityToTheTimeOffset) {
  constexpr double kDelay = 1e-5;
  const BundleSettings settings{.iterations = 10, .convergence = 0.0, .robust_width = kNoRobustWidth};
  for (const int free_frames : {1, 3}) {
    for (const double offset : kOffsets) {
      const LandmarkScene scene{.free_frames = free_frames, .offset = offset};
      const BundleProblem truth = test::simulateProblem(scene, 1);
      BundleProblem late = withDelay(scene, kDelay);
      ASSERT_TRUE(test::adjustBundle(late, settings).converged);
      for (int i = 0; i < free_frames; ++i) {
        const Vector6d expected = test::poseErrors(late).segment<6>(6 * i) / kDelay;
        const Vector6d& reported = late.poses[late.fixed + i].dpose_doffset;
        EXPECT_GT(expected.norm(), 0.01);
        EXPECT_LT((reported - expected).norm(), 0.01 * expected.norm()) << free_frames << " free, " << offset;
      }
      for (std::size_t i = 0; i < truth.landmarks.size(); ++i) {
        const double expected = (late.landmarks[i].inverse_depth - truth.landmarks[i].inverse_depth) / kDelay;
        EXPECT_NEAR(late.landmarks[i].dinverse_depth_doffset, expected, 0.01 * std::abs(expected) + 1e-3);
      }
    }
  }
}

TEST(BundleAdjustment, PropagatesTimeOffsetSensitivityOfPosesAndPriors) {
  constexpr double kDelay = 1e-5;
  const LandmarkScene scene{.offset = 0.01};
  BundleProblem late = withDelay(scene, kDelay);
  late.poses[5].dpose_doffset = test::vector6(0.3, -0.1, 0.4, 0.02, 0.05, -0.01);
  late.poses[5].T_world_camera =
      late.poses[5].T_world_camera * motionFromVector(kDelay * late.poses[5].dpose_doffset);
  for (BundleLandmark& landmark : late.landmarks) {
    landmark.prior_information = 1e4;
    landmark.prior_dinverse_depth_doffset = 2.0;
    landmark.prior_inverse_depth = landmark.inverse_depth + 2.0 * kDelay;
  }
  ASSERT_TRUE(test::adjustBundle(late, {.iterations = 10, .convergence = 0.0, .robust_width = kNoRobustWidth})
                  .converged);
  const Vector6d expected = test::poseErrors(late) / kDelay;
  EXPECT_LT((late.poses.back().dpose_doffset - expected).norm(), 0.01 * expected.norm());
}

/// Reference implementation of the normalised residuals: left position (except in the anchor) and disparity
/// of each observation.
Eigen::VectorXd residualsOf(const BundleProblem& problem) {
  std::vector<double> residuals;
  for (const BundleLandmark& landmark : problem.landmarks) {
    const Eigen::Isometry3d& T_world_anchor =
        problem.poses[landmark.observations.front().pose].T_world_camera;
    const auto pixel_by = [&](const Eigen::Isometry3d& T_world_camera) {
      return projectLandmark(problem.camera, T_world_camera.inverse() * T_world_anchor, landmark.bearing,
                             landmark.inverse_depth)
          .pixel;
    };
    for (const BundleObservation& observation : landmark.observations) {
      const Eigen::Vector2d left = pixel_by(problem.poses[observation.pose].T_world_camera);
      if (&observation != &landmark.observations.front())
        for (int axis = 0; axis < 2; ++axis)
          residuals.push_back((observation.left[axis] - left[axis]) / problem.noise.front().pixel);
      if (!observation.stereo) continue;
      const Eigen::Vector2d right =
          pixel_by(rightCameraOf(problem.poses, observation.pose, problem.camera.baseline).T_world_camera);
      const double stddev =
          problem.noise.front().disparity + problem.noise.front().stretch * std::abs(observation.disparity());
      residuals.push_back((observation.disparity() - (left.x() - right.x())) / stddev);
    }
  }
  return Eigen::Map<Eigen::VectorXd>(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
}

/// Numerical derivatives of residualsOf() by the free poses and all inverse depths.
Eigen::MatrixXd derivativesOf(const BundleProblem& problem) {
  constexpr double kStep = 1e-6;
  const int of_poses = 6 * (static_cast<int>(problem.poses.size()) - problem.fixed);
  const int unknowns = of_poses + static_cast<int>(problem.landmarks.size());
  Eigen::MatrixXd derivatives(residualsOf(problem).size(), unknowns);
  for (int i = 0; i < unknowns; ++i) {
    const auto moved = [&](double step) {
      BundleProblem changed = problem;
      if (i < of_poses) {
        Eigen::Isometry3d& pose = changed.poses[problem.fixed + i / 6].T_world_camera;
        pose = pose * motionFromVector(step * Vector6d::Unit(i % 6));
      } else {
        changed.landmarks[i - of_poses].inverse_depth += step;
      }
      return residualsOf(changed);
    };
    derivatives.col(i) = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
  }
  return derivatives;
}

TEST(BundleAdjustment, AgreesWithDenseNormalEquations) {
  for (const int free_frames : {1, 3, 6}) {
    for (const double offset : kOffsets) {
      BundleProblem problem = test::simulateProblem(
          {.free_frames = free_frames, .landmarks = 25, .offset = offset, .noise = 1.0}, 1);
      for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
        problem.landmarks[i].weight = 0.5 + 0.02 * static_cast<double>(i);
        if (i % 3 == 0) problem.landmarks[i].observations.back().stereo = false;
      }
      const BundleResult result =
          test::adjustBundle(problem, {.iterations = 20, .convergence = 0.0, .robust_width = kNoRobustWidth});
      ASSERT_TRUE(result.converged);
      Eigen::VectorXd weights(residualsOf(problem).size());
      Eigen::Index row = 0;
      for (const BundleLandmark& landmark : problem.landmarks)
        for (const BundleObservation& observation : landmark.observations) {
          const bool is_anchor = &observation == &landmark.observations.front();
          const int rows = (is_anchor ? 0 : 2) + (observation.stereo ? 1 : 0);
          weights.segment(row, rows).setConstant(landmark.weight);
          row += rows;
        }
      const Eigen::MatrixXd J = derivativesOf(problem);
      const Eigen::MatrixXd H = J.transpose() * weights.asDiagonal() * J;
      const Eigen::VectorXd step =
          H.ldlt().solve(J.transpose() * weights.asDiagonal() * residualsOf(problem));
      EXPECT_LT(step.cwiseAbs().maxCoeff(), 1e-6) << free_frames << " free, " << offset << " s";
      const Eigen::Index of_poses = result.covariance.rows();
      const Eigen::MatrixXd covariance = H.inverse().topLeftCorner(of_poses, of_poses);
      EXPECT_LT((result.covariance - covariance).norm(), 1e-4 * covariance.norm())
          << free_frames << " free, " << offset << " s";
      for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
        const Eigen::Index at = of_poses + static_cast<Eigen::Index>(i);
        EXPECT_NEAR(problem.landmarks[i].information, H(at, at), 1e-5 * H(at, at));
      }
    }
  }
}

constexpr int kTrials = 200;

/// Mean over the trials of the pose's squared error normalised by its covariance.
double meanNees(const LandmarkScene& scene, double robust_width) {
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    BundleProblem problem = test::simulateProblem(scene, 1000 + trial);
    const BundleResult result =
        test::adjustBundle(problem, {.convergence = 0.0, .robust_width = robust_width});
    EXPECT_TRUE(result.converged);
    const Eigen::VectorXd error = test::poseErrors(problem);
    sum += error.dot(result.covariance.ldlt().solve(error));
  }
  return sum / kTrials;
}

/// 99 % confidence half-width of the mean of kTrials chi-squared numbers.
double bandOf(double degrees) {
  return 2.6 * std::sqrt(2.0 * degrees / kTrials);
}

TEST(BundleAdjustment, CovarianceWithoutRobustWeightsIsConsistent) {
  for (const double offset : kOffsets) {
    LandmarkScene scene{.landmarks = 35, .offset = offset, .noise = 1.0};
    EXPECT_NEAR(meanNees(scene, kNoRobustWidth), 6.0, bandOf(6.0)) << offset;
    scene.noise = 2.0;  // inconsistent if the noise is not the assumed one
    EXPECT_GT(meanNees(scene, kNoRobustWidth), 6.0 + 3.0 * bandOf(6.0)) << offset;
  }
  EXPECT_NEAR(meanNees({.free_frames = 3, .landmarks = 35, .noise = 1.0}, kNoRobustWidth), 18.0,
              bandOf(18.0));
}

TEST(BundleAdjustment, CovarianceWithRobustWeightsIsSlightlyConservative) {
  // Robust weights reduce the weight of Gaussian noise, too.
  LandmarkScene scene{.landmarks = 35, .offset = 0.02, .noise = 1.0};
  const double plain = meanNees(scene, kNoRobustWidth);
  const double robust = meanNees(scene, BundleSettings{}.robust_width);
  EXPECT_LT(robust, plain);
  EXPECT_GT(robust, 0.8 * plain);
  EXPECT_NEAR(robust, 6.0, bandOf(6.0));
  scene.noise = 2.0;
  EXPECT_GT(meanNees(scene, BundleSettings{}.robust_width), 6.0 + 3.0 * bandOf(6.0));
}

TEST(BundleAdjustment, RigInformationIsConsistent) {
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    BundleProblem problem = test::simulateProblem({.free_frames = 3, .noise = 1.0}, 1000 + trial);
    const BundleResult result = test::adjustBundle(problem, {.robust_width = kNoRobustWidth});
    sum += result.rig_gradient.dot(result.rig_information.ldlt().solve(result.rig_gradient));
  }
  EXPECT_NEAR(sum / kTrials, 2.0, bandOf(2.0));
}

TEST(BundleAdjustment, IsRobustAgainstTwentyPercentWrongDisparities) {
  for (const double offset : kOffsets) {
    BundleProblem problem = test::simulateProblem(
        {.landmarks = 100, .offset = offset, .noise = 1.0, .wrong_disparities = 0.2}, 5);
    test::disturb(problem);
    const BundleResult result = test::adjustBundle(problem, {.iterations = 10, .convergence = 0.0});
    ASSERT_TRUE(result.converged);
    const Eigen::ArrayXd stddev = result.covariance.diagonal().cwiseSqrt();
    EXPECT_LT((test::poseErrors(problem).array().abs() / stddev).maxCoeff(), 4.0) << offset;
  }
}

TEST(BundleAdjustment, ReusedAdjusterGivesTheSameResult) {
  BundleAdjuster kept;
  for (const LandmarkScene& scene :
       {LandmarkScene{.free_frames = 3, .landmarks = 200, .offset = 0.02, .noise = 1.0},
        LandmarkScene{.landmarks = 30, .noise = 1.0}, LandmarkScene{.free_frames = 2, .noise = 1.0}}) {
    BundleProblem once = test::simulateProblem(scene, 1), again = once;
    const BundleResult fresh = test::adjustBundle(once, BundleSettings{});
    const BundleResult result = kept.adjust(again, BundleSettings{});
    ASSERT_TRUE(result.converged);
    EXPECT_EQ(result.covariance, fresh.covariance);
    EXPECT_EQ(result.rig_gradient, fresh.rig_gradient);
    EXPECT_EQ(result.noise_scale.front().disparity, fresh.noise_scale.front().disparity);
    EXPECT_EQ(again.poses.back().T_world_camera.matrix(), once.poses.back().T_world_camera.matrix());
    EXPECT_EQ(again.poses.back().dpose_doffset, once.poses.back().dpose_doffset);
    for (std::size_t i = 0; i < once.landmarks.size(); ++i) {
      EXPECT_EQ(again.landmarks[i].inverse_depth, once.landmarks[i].inverse_depth);
      EXPECT_EQ(again.landmarks[i].error, once.landmarks[i].error);
    }
  }
}

TEST(BundleAdjustment, LimitsPosesAndObservationsToTheWindow) {
  BundleProblem problem = test::simulateProblem({}, 1);
  EXPECT_THROW(problem.poses.resize(kMaximumWindowPairs + 1), std::length_error);
  auto& observations = problem.landmarks.front().observations;
  observations.resize(kMaximumWindowPairs);
  EXPECT_THROW(observations.emplace_back(), std::length_error);
  EXPECT_EQ(observations.size(), kMaximumWindowPairs);
}

TEST(BundleAdjustment, LandmarkWithoutStereoKeepsItsPriorDepth) {
  BundleProblem problem = test::simulateProblem({}, 1);
  BundleLandmark& lone = problem.landmarks.front();
  lone.observations.resize(1);
  lone.observations[0].stereo = false;
  lone.inverse_depth = 0.5;
  lone.prior_inverse_depth = 0.1;
  lone.prior_information = 100.0;
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  EXPECT_NEAR(lone.inverse_depth, 0.1, 1e-9);
  EXPECT_NEAR(lone.information, 100.0, 1e-9);
}

TEST(BundleAdjustment, IgnoresLandmarkBehindTheCamera) {
  BundleProblem problem = test::simulateProblem({}, 1);
  BundleLandmark& behind = problem.landmarks.front();
  behind.inverse_depth = 5.0;  // 0.2 m ahead of its anchor; later cameras are farther ahead
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  EXPECT_EQ(behind.information, 0.0);
  EXPECT_GT(behind.error, 100.0);
  EXPECT_LT(test::poseErrors(problem).norm(), 1e-6);
}

TEST(BundleAdjustment, UsesLandmarkBehindCamerasThatDoNotObserveIt) {
  BundleProblem problem = test::simulateProblem({}, 1);
  BundleLandmark& passed = problem.landmarks.front();
  ASSERT_EQ(passed.observations.front().pose, 0);
  passed.bearing = {0.1, 0.1, 1.0};
  passed.inverse_depth = 2.0;  // 0.5 m ahead of its anchor; the last camera is 0.9 m ahead
  passed.observations.resize(2);
  for (BundleObservation& observation : passed.observations) {
    const Eigen::Isometry3d& T_world_camera = problem.poses[observation.pose].T_world_camera;
    const auto pixel_by = [&](const Eigen::Isometry3d& camera) {
      return projectLandmark(problem.camera, camera.inverse() * problem.poses[0].T_world_camera,
                             passed.bearing, passed.inverse_depth)
          .pixel;
    };
    observation.left = pixel_by(T_world_camera);
    observation.right = pixel_by(test::rightOf(T_world_camera));
  }
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  EXPECT_GT(passed.information, 0.0);
  EXPECT_NEAR(passed.inverse_depth, 2.0, 1e-6);
  EXPECT_LT(passed.error, 1e-3);
}

TEST(BundleAdjustment, DoesNotConvergeWithTooFewLandmarks) {
  BundleProblem problem = test::simulateProblem({}, 1);
  problem.landmarks.resize(1);
  EXPECT_FALSE(test::adjustBundle(problem, BundleSettings{}).converged);
  problem.landmarks.clear();
  EXPECT_FALSE(test::adjustBundle(problem, BundleSettings{}).converged);
}

}  // namespace
}  // namespace cartvo::vo
