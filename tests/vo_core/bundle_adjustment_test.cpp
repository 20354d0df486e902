// The least squares on landmarks whose places and poses are known.
#include "vo_core/bundle_adjustment.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "vo_core/landmark_scene.hpp"

namespace cartvo {
namespace {

using test::LandmarkScene;

constexpr double kOffsets[] = {-0.02, 0.0, 0.02};  // s
constexpr double kPlain = 1e6;                     // width of a robust weight that is always one

TEST(BundleAdjustment, FindsPosesAndDepthsExactlyWithoutNoise) {
  const BundleSettings settings{.iterations = 20, .convergence = 0.0};
  for (const int free_frames : {1, 3}) {
    for (const double offset : kOffsets) {
      const LandmarkScene scene{.free_frames = free_frames, .offset = offset};
      const BundleProblem truth = test::seenBy(scene, 1);
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
  // Only derivatives that are right to the last term let one step from nearby end at the truth.
  constexpr double kNearby = 1e-4;
  for (const int free_frames : {1, 3, 6}) {
    for (const double offset : kOffsets) {
      BundleProblem problem = test::seenBy({.free_frames = free_frames, .offset = offset}, 1);
      test::disturb(problem, kNearby);
      const double before = test::poseErrors(problem).norm();
      ASSERT_TRUE(test::adjustBundle(problem, {.iterations = 1, .robust_width = kPlain}).converged);
      EXPECT_LT(test::poseErrors(problem).norm(), 1e-4 * before)
          << free_frames << " free, " << offset << " s";
    }
  }
}

TEST(BundleAdjustment, TakingTwoInstantsForOneMovesThePose) {
  // That the tests with an offset would fail if it were ignored.
  BundleProblem problem = test::seenBy({.offset = 0.02}, 1);
  for (TimedPose& pose : problem.poses)
    pose.offset = 0.0;
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  EXPECT_GT(test::poseErrors(problem).head<3>().norm(), 0.001);
}

/// Every other landmark's positions twenty times as noisy, and said to be so or not; what the pose errs by.
double errorAmongNoisyLandmarks(bool said) {
  constexpr double kRelative = 20.0;
  double squares = 0.0;
  for (int seed = 1; seed <= 5; ++seed) {
    BundleProblem problem = test::seenBy({.noise = 0.3}, seed);
    const BundleProblem exact = test::seenBy({}, seed);
    for (std::size_t i = 0; i < problem.landmarks.size(); i += 2) {
      auto& sightings = problem.landmarks[i].sightings;
      for (std::size_t k = 1; k < sightings.size(); ++k) {  // what the host saw defines the landmark
        const Eigen::Vector2d& truth = exact.landmarks[i].sightings[k].left;
        const Eigen::Vector2d more = (kRelative - 1.0) * (sightings[k].left - truth);
        sightings[k].left += more;
        sightings[k].right += more;  // the disparity stays as good as it was
        if (said) sightings[k].relative_noise.setConstant(kRelative);
      }
    }
    EXPECT_TRUE(test::adjustBundle(problem, {.iterations = 10, .convergence = 0.0, .robust_width = kPlain})
                    .converged);
    squares += test::poseErrors(problem).squaredNorm();
  }
  return std::sqrt(squares);
}

TEST(BundleAdjustment, WeighsPositionsByTheirNoise) {
  EXPECT_LT(3.0 * errorAmongNoisyLandmarks(true), errorAmongNoisyLandmarks(false));
}

TEST(BundleAdjustment, FixedPosesStand) {
  BundleProblem problem = test::seenBy({.free_frames = 3, .noise = 1.0}, 1);
  const TimedPoses before = problem.poses;
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(problem.poses[i].T_world_camera.matrix() == before[i].T_world_camera.matrix(), i < 4) << i;
}

/// The problem as it is if all right cameras are exposed later than is believed.
BundleProblem withDelay(const LandmarkScene& scene, double delay) {
  BundleProblem problem = test::seenBy(scene, 1);
  for (TimedPose& pose : problem.poses)
    pose.offset -= delay;
  return problem;
}

TEST(BundleAdjustment, SaysHowTheResultErrsIfRightCamerasAreLate) {
  constexpr double kDelay = 1e-5;
  const BundleSettings settings{.iterations = 10, .convergence = 0.0, .robust_width = kPlain};
  for (const int free_frames : {1, 3}) {
    for (const double offset : kOffsets) {
      const LandmarkScene scene{.free_frames = free_frames, .offset = offset};
      const BundleProblem truth = test::seenBy(scene, 1);
      BundleProblem late = withDelay(scene, kDelay);
      ASSERT_TRUE(test::adjustBundle(late, settings).converged);
      for (int i = 0; i < free_frames; ++i) {
        const Vector6d expected = test::poseErrors(late).segment<6>(6 * i) / kDelay;
        const Vector6d& said = late.poses[late.fixed + i].by_late_right;
        EXPECT_GT(expected.norm(), 0.01);
        EXPECT_LT((said - expected).norm(), 0.01 * expected.norm()) << free_frames << " free, " << offset;
      }
      for (std::size_t i = 0; i < truth.landmarks.size(); ++i) {
        const double expected = (late.landmarks[i].inverse_depth - truth.landmarks[i].inverse_depth) / kDelay;
        EXPECT_NEAR(late.landmarks[i].by_late_right, expected, 0.01 * std::abs(expected) + 1e-3);
      }
    }
  }
}

TEST(BundleAdjustment, PassesOnWhatLateRightCamerasDidToPosesAndPriors) {
  constexpr double kDelay = 1e-5;
  const LandmarkScene scene{.offset = 0.01};
  BundleProblem late = withDelay(scene, kDelay);
  late.poses[5].by_late_right = test::vector6(0.3, -0.1, 0.4, 0.02, 0.05, -0.01);
  late.poses[5].T_world_camera =
      late.poses[5].T_world_camera * motionFromVector(kDelay * late.poses[5].by_late_right);
  for (BundleLandmark& landmark : late.landmarks) {
    landmark.prior_information = 1e4;
    landmark.prior_by_late_right = 2.0;
    landmark.prior_inverse_depth = landmark.inverse_depth + 2.0 * kDelay;
  }
  ASSERT_TRUE(
      test::adjustBundle(late, {.iterations = 10, .convergence = 0.0, .robust_width = kPlain}).converged);
  const Vector6d expected = test::poseErrors(late) / kDelay;
  EXPECT_LT((late.poses.back().by_late_right - expected).norm(), 0.01 * expected.norm());
}

/// Residuals in standard deviations, plainly: of each sighting the left position, but at the host, and the
/// disparity.
Eigen::VectorXd residualsOf(const BundleProblem& problem) {
  std::vector<double> residuals;
  for (const BundleLandmark& landmark : problem.landmarks) {
    const Eigen::Isometry3d& T_world_host = problem.poses[landmark.sightings.front().pose].T_world_camera;
    const auto pixel_by = [&](const Eigen::Isometry3d& T_world_camera) {
      return projectLandmark(problem.camera, T_world_camera.inverse() * T_world_host, landmark.bearing,
                             landmark.inverse_depth)
          .pixel;
    };
    for (const BundleSighting& sighting : landmark.sightings) {
      const Eigen::Vector2d left = pixel_by(problem.poses[sighting.pose].T_world_camera);
      if (&sighting != &landmark.sightings.front())
        for (int axis = 0; axis < 2; ++axis)
          residuals.push_back((sighting.left[axis] - left[axis]) / problem.noise.front().pixel);
      if (!sighting.stereo) continue;
      const Eigen::Vector2d right =
          pixel_by(rightCameraOf(problem.poses, sighting.pose, problem.camera.baseline).T_world_camera);
      const double deviation =
          problem.noise.front().disparity + problem.noise.front().stretch * std::abs(sighting.disparity());
      residuals.push_back((sighting.disparity() - (left.x() - right.x())) / deviation);
    }
  }
  return Eigen::Map<Eigen::VectorXd>(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
}

/// Their derivatives by the free poses and all inverse depths, by central differences.
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

TEST(BundleAdjustment, SolvesThePlainEquationsOfAllPosesAndDepths) {
  for (const int free_frames : {1, 3, 6}) {
    for (const double offset : kOffsets) {
      BundleProblem problem =
          test::seenBy({.free_frames = free_frames, .landmarks = 25, .offset = offset, .noise = 1.0}, 1);
      for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
        problem.landmarks[i].weight = 0.5 + 0.02 * static_cast<double>(i);
        if (i % 3 == 0) problem.landmarks[i].sightings.back().stereo = false;
      }
      const BundleResult result =
          test::adjustBundle(problem, {.iterations = 20, .convergence = 0.0, .robust_width = kPlain});
      ASSERT_TRUE(result.converged);
      Eigen::VectorXd weights(residualsOf(problem).size());
      Eigen::Index row = 0;
      for (const BundleLandmark& landmark : problem.landmarks)
        for (const BundleSighting& sighting : landmark.sightings) {
          const bool is_host = &sighting == &landmark.sightings.front();
          const int rows = (is_host ? 0 : 2) + (sighting.stereo ? 1 : 0);
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
    BundleProblem problem = test::seenBy(scene, 1000 + trial);
    const BundleResult result =
        test::adjustBundle(problem, {.convergence = 0.0, .robust_width = robust_width});
    EXPECT_TRUE(result.converged);
    const Eigen::VectorXd error = test::poseErrors(problem);
    sum += error.dot(result.covariance.ldlt().solve(error));
  }
  return sum / kTrials;
}

/// The mean of so many chi-squared numbers lies so near its expectation in 99 % of all cases.
double bandOf(double degrees) {
  return 2.6 * std::sqrt(2.0 * degrees / kTrials);
}

TEST(BundleAdjustment, CovarianceOfPlainLeastSquaresAgreesWithTheErrors) {
  for (const double offset : kOffsets) {
    LandmarkScene scene{.landmarks = 35, .offset = offset, .noise = 1.0};
    EXPECT_NEAR(meanNees(scene, kPlain), 6.0, bandOf(6.0)) << offset;
    scene.noise = 2.0;  // no more so if the noise is not what is assumed
    EXPECT_GT(meanNees(scene, kPlain), 6.0 + 3.0 * bandOf(6.0)) << offset;
  }
  EXPECT_NEAR(meanNees({.free_frames = 3, .landmarks = 35, .noise = 1.0}, kPlain), 18.0, bandOf(18.0));
}

TEST(BundleAdjustment, RobustWeightsMakeTheCovarianceALittleCautious) {
  // Normal noise, too, is given less than its full weight.
  LandmarkScene scene{.landmarks = 35, .offset = 0.02, .noise = 1.0};
  const double plain = meanNees(scene, kPlain);
  const double robust = meanNees(scene, BundleSettings{}.robust_width);
  EXPECT_LT(robust, plain);
  EXPECT_GT(robust, 0.8 * plain);
  EXPECT_NEAR(robust, 6.0, bandOf(6.0));
  scene.noise = 2.0;
  EXPECT_GT(meanNees(scene, BundleSettings{}.robust_width), 6.0 + 3.0 * bandOf(6.0));
}

TEST(BundleAdjustment, RigGradientIsItsInformationTimesTheChange) {
  const RigCorrection rig{1e-5, -2e-5};
  for (const double offset : kOffsets) {
    BundleProblem problem =
        test::seenBy({.free_frames = 3, .landmarks = 20, .offset = offset, .rig = rig}, 1);
    const BundleResult result =
        test::adjustBundle(problem, {.iterations = 10, .convergence = 0.0, .robust_width = kPlain});
    const RigCorrection::Vector found = result.rig_information.ldlt().solve(result.rig_gradient);
    EXPECT_NEAR(found[0], rig.yaw, 1e-7) << offset;
    EXPECT_NEAR(found[1], rig.bend, 2e-7) << offset;
  }
}

TEST(BundleAdjustment, RigInformationAgreesWithTheErrors) {
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    BundleProblem problem = test::seenBy({.free_frames = 3, .noise = 1.0}, 1000 + trial);
    const BundleResult result = test::adjustBundle(problem, {.robust_width = kPlain});
    sum += result.rig_gradient.dot(result.rig_information.ldlt().solve(result.rig_gradient));
  }
  EXPECT_NEAR(sum / kTrials, 2.0, bandOf(2.0));
}

TEST(BundleAdjustment, EndsWhereItWouldWithoutThemIfAFifthOfTheDisparitiesIsWrong) {
  for (const double offset : kOffsets) {
    BundleProblem problem =
        test::seenBy({.landmarks = 100, .offset = offset, .noise = 1.0, .wrong_disparities = 0.2}, 5);
    test::disturb(problem);
    BundleProblem clean = test::seenBy({.landmarks = 100, .offset = offset, .noise = 1.0}, 5);
    const BundleResult result = test::adjustBundle(problem, {.iterations = 10, .convergence = 0.0});
    test::adjustBundle(clean, {.iterations = 10, .convergence = 0.0});
    ASSERT_TRUE(result.converged);
    const Eigen::ArrayXd deviation = result.covariance.diagonal().cwiseSqrt();
    EXPECT_LT((test::poseErrors(problem).array().abs() / deviation).maxCoeff(), 4.0) << offset;
  }
}

TEST(BundleAdjustment, WhatAnAdjusterKeepsChangesNoResult) {
  BundleAdjuster kept;
  for (const LandmarkScene& scene :
       {LandmarkScene{.free_frames = 3, .landmarks = 200, .offset = 0.02, .noise = 1.0},
        LandmarkScene{.landmarks = 30, .noise = 1.0}, LandmarkScene{.free_frames = 2, .noise = 1.0}}) {
    BundleProblem once = test::seenBy(scene, 1), again = once;
    const BundleResult fresh = test::adjustBundle(once, BundleSettings{});
    const BundleResult result = kept.adjust(again, BundleSettings{});
    ASSERT_TRUE(result.converged);
    EXPECT_EQ(result.covariance, fresh.covariance);
    EXPECT_EQ(result.rig_gradient, fresh.rig_gradient);
    EXPECT_EQ(result.noise_scale.front().disparity, fresh.noise_scale.front().disparity);
    EXPECT_EQ(again.poses.back().T_world_camera.matrix(), once.poses.back().T_world_camera.matrix());
    EXPECT_EQ(again.poses.back().by_late_right, once.poses.back().by_late_right);
    for (std::size_t i = 0; i < once.landmarks.size(); ++i) {
      EXPECT_EQ(again.landmarks[i].inverse_depth, once.landmarks[i].inverse_depth);
      EXPECT_EQ(again.landmarks[i].error, once.landmarks[i].error);
    }
  }
}

TEST(BundleAdjustment, RefusesMorePosesAndSightingsThanAWindowHas) {
  BundleProblem problem = test::seenBy({}, 1);
  EXPECT_THROW(problem.poses.resize(kMostWindowPairs + 1), std::length_error);
  auto& sightings = problem.landmarks.front().sightings;
  sightings.resize(kMostWindowPairs);
  EXPECT_THROW(sightings.emplace_back(), std::length_error);
  EXPECT_EQ(sightings.size(), kMostWindowPairs);
}

TEST(BundleAdjustment, ALandmarkWithoutStereoStandsByItsPrior) {
  BundleProblem problem = test::seenBy({}, 1);
  BundleLandmark& lone = problem.landmarks.front();
  lone.sightings.resize(1);
  lone.sightings[0].stereo = false;
  lone.inverse_depth = 0.5;
  lone.prior_inverse_depth = 0.1;
  lone.prior_information = 100.0;
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  EXPECT_NEAR(lone.inverse_depth, 0.1, 1e-9);
  EXPECT_NEAR(lone.information, 100.0, 1e-9);
}

TEST(BundleAdjustment, ALandmarkBehindTheCameraIsLeftOut) {
  BundleProblem problem = test::seenBy({}, 1);
  BundleLandmark& behind = problem.landmarks.front();
  behind.inverse_depth = 5.0;  // 0.2 m ahead of a host that has since moved on by more
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  EXPECT_EQ(behind.information, 0.0);
  EXPECT_GT(behind.error, 100.0);
  EXPECT_LT(test::poseErrors(problem).norm(), 1e-6);
}

TEST(BundleAdjustment, ALandmarkCountsThatIsBehindCamerasWhichNoLongerSeeIt) {
  BundleProblem problem = test::seenBy({}, 1);
  BundleLandmark& passed = problem.landmarks.front();
  ASSERT_EQ(passed.sightings.front().pose, 0);
  passed.bearing = {0.1, 0.1, 1.0};
  passed.inverse_depth = 2.0;  // 0.5 m ahead of its host; the last one has moved on by 0.9 m
  passed.sightings.resize(2);
  for (BundleSighting& sighting : passed.sightings) {
    const Eigen::Isometry3d& T_world_camera = problem.poses[sighting.pose].T_world_camera;
    const auto pixel_by = [&](const Eigen::Isometry3d& camera) {
      return projectLandmark(problem.camera, camera.inverse() * problem.poses[0].T_world_camera,
                             passed.bearing, passed.inverse_depth)
          .pixel;
    };
    sighting.left = pixel_by(T_world_camera);
    sighting.right = pixel_by(test::rightOf(T_world_camera));
  }
  ASSERT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
  EXPECT_GT(passed.information, 0.0);
  EXPECT_NEAR(passed.inverse_depth, 2.0, 1e-6);
  EXPECT_LT(passed.error, 1e-3);
}

TEST(BundleAdjustment, SaysWhenThePoseIsLeftOpen) {
  BundleProblem problem = test::seenBy({}, 1);
  problem.landmarks.resize(1);
  EXPECT_FALSE(test::adjustBundle(problem, BundleSettings{}).converged);
  problem.landmarks.clear();
  EXPECT_FALSE(test::adjustBundle(problem, BundleSettings{}).converged);
}

}  // namespace
}  // namespace cartvo
