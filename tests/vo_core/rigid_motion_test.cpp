// Tests of rigid motions, of the stereo camera's geometry and of feature history.
#include "vo_core/rigid_motion.hpp"

#include <Eigen/Eigenvalues>

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/geometry/pose_drift.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/thesis/feature_history.hpp"

namespace cartvo::vo {
namespace {

Eigen::Isometry3d someMotion() {
  Vector6d vector;
  vector << 1.0, -0.5, 2.0, 0.3, -0.2, 0.5;
  return motionFromVector(vector);
}

TEST(RigidMotion, ConvertsToAVectorAndBack) {
  Vector6d vector;
  vector << 1, -2, 3, 0.1, 0.2, -0.3;
  EXPECT_LT((vectorFromMotion(motionFromVector(vector)) - vector).norm(), 1e-12);
  EXPECT_LT(vectorFromMotion(Eigen::Isometry3d::Identity()).norm(), 1e-12);
}

TEST(RigidMotion, AdjointCarriesAPerturbationFromRightToLeft) {
  Vector6d small;
  small << 1e-6, -2e-6, 3e-6, 2e-6, 1e-6, -1e-6;
  const Eigen::Isometry3d T = someMotion();
  const Eigen::Isometry3d right = T * motionFromVector(small);
  const Eigen::Isometry3d left = motionFromVector(adjoint(T) * small) * T;
  EXPECT_LT((right.matrix() - left.matrix()).norm(), 1e-10);
}

TEST(RigidMotion, CovarianceOfAChainAgreesWithSimulation) {
  const Eigen::Isometry3d motion = someMotion();
  Matrix6d pose_covariance = Matrix6d::Identity() * 1e-4;
  pose_covariance(0, 4) = pose_covariance(4, 0) = 5e-5;
  const Matrix6d motion_covariance = Matrix6d::Identity() * 4e-5;
  const Matrix6d pose_root = pose_covariance.llt().matrixL();
  test::Noise noise(1);
  const auto gaussian = [&] {
    Vector6d vector;
    for (int i = 0; i < 6; ++i)
      vector[i] = noise.gaussian();
    return vector;
  };
  Matrix6d sum = Matrix6d::Zero();
  constexpr int kTrials = 20000;
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::Isometry3d noisy =
        motionFromVector(pose_root * gaussian()) * motion * motionFromVector(std::sqrt(4e-5) * gaussian());
    const Vector6d error = vectorFromMotion(motion.inverse() * noisy);
    sum += error * error.transpose();
  }
  const Matrix6d expected = composedCovariance(pose_covariance, motion, motion_covariance);
  EXPECT_LT((sum / kTrials - expected).norm(), 0.04 * expected.norm());
}

TEST(RigidMotion, StaysOrthonormalUnderRepeatedInversion) {
  const Eigen::Isometry3d step = someMotion();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 200; ++i)
    pose = orthonormalised(pose * orthonormalised(pose.inverse() * (pose * step)));
  EXPECT_LT((pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

const StereoCamera kCamera{700.0, 320.0, 240.0, 0.5, 640, 480};

TEST(StereoCamera, TriangulatesWhatItProjects) {
  const Eigen::Vector3d point(1.5, -0.7, 12.0);
  const StereoMeasurement measurement{project(kCamera, point), 700.0 * 0.5 / 12.0};
  EXPECT_LT((triangulate(kCamera, measurement) - point).norm(), 1e-12);
}

TEST(StereoCamera, CovarianceOfAPointAgreesWithSimulation) {
  const Eigen::Vector3d point(4.0, -2.0, 20.0);
  const Eigen::Vector2d pixel = project(kCamera, point);
  test::Noise noise(3);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  constexpr int kTrials = 20000;
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::Vector2d offset(0.1 * noise.gaussian(), 0.1 * noise.gaussian());
    const Eigen::Vector3d error =
        triangulate(kCamera, {pixel + offset, 700.0 * 0.5 / 20.0 + 0.1 * noise.gaussian()}) - point;
    sum += error * error.transpose();
  }
  const Eigen::Matrix3d expected = pointCovariance(kCamera, point, 0.1, 0.1);
  EXPECT_LT((sum / kTrials - expected).norm(), 0.05 * expected.norm());
}

TEST(StereoCamera, RejectsInvalidValuesByName) {
  StereoCamera camera = kCamera;
  camera.baseline = -0.1;
  try {
    validate(camera);
    FAIL() << "not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "stereo camera: baseline is -0.1: expected more than 0 m");
  }
}

TEST(FeatureHistory, MovingFeatureLosesItsWeightWithinFivePairs) {
  const HistorySettings settings;
  const Eigen::Matrix3d covariance = 0.01 * Eigen::Matrix3d::Identity();
  const WorldStep walking{Eigen::Vector3d(0.8, 0.0, 0.0), covariance};  // 8 standard deviations a pair
  double weight = 1.0;
  int pairs = 0;
  for (; weight >= settings.minimum_weight && pairs < 100; ++pairs)
    weight = historyWeight(weight, motionVariance(walking, walking), settings);
  EXPECT_LE(pairs, 5);
}

TEST(FeatureHistory, StaticFeatureKeepsItsWeight) {
  const HistorySettings settings;
  test::Noise noise(9);
  const auto step = [&] {
    return WorldStep{0.1 * Eigen::Vector3d(noise.gaussian(), noise.gaussian(), noise.gaussian()),
                     0.01 * Eigen::Matrix3d::Identity()};
  };
  double weight = 1.0;
  double least = 1.0;
  for (int i = 0; i < 1000; ++i) {
    weight = historyWeight(weight, motionVariance(step(), step()), settings);
    least = std::min(least, weight);
  }
  EXPECT_GT(least, 2.0 * settings.minimum_weight);
}

const Eigen::Isometry3d kAhead(Eigen::Translation3d(0.0, 0.0, 0.3));

Matrix6d noise() {
  Vector6d variances;
  variances << 1e-8, 2e-8, 4e-8, 1e-10, 2e-10, 3e-10;
  return variances.asDiagonal();
}

PoseUncertainty propagate(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                          const Matrix6d& errors = noise()) {
  return afterMotion(before, motion, errors, UncertaintySettings());
}

double heightVariance(int pairs) {
  PoseUncertainty known;
  for (int pair = 0; pair < pairs; ++pair)
    known = propagate(known, Eigen::Isometry3d::Identity());
  return known.pose(1, 1);
}

TEST(PoseDrift, VarianceGrowsFasterThanLinearlyAtFirstAndLinearlyLater) {
  EXPECT_GT(heightVariance(20) / heightVariance(5), 8.0);
  EXPECT_NEAR(heightVariance(20'000) / heightVariance(10'000), 2.0, 0.05);
}

TEST(PoseDrift, HeadingErrorsBecomeLateralErrors) {
  PoseUncertainty known;
  known.pose(4, 4) = 1e-4;
  const Matrix6d nothing = Matrix6d::Zero();
  const Matrix6d carried = propagate(known, kAhead, nothing).pose;
  EXPECT_TRUE(carried.isApprox(composedCovariance(known.pose, kAhead, nothing)));
  EXPECT_NEAR(carried(0, 0), 0.3 * 0.3 * 1e-4, 1e-12);
}

TEST(PoseDrift, StaysPositiveDefiniteInCurves) {
  Vector6d curve;
  curve << 0.0, 0.0, 0.3, 0.001, 0.05, -0.002;
  PoseUncertainty known;
  double volume = 0.0;
  for (int pair = 0; pair < 500; ++pair) {
    known = propagate(known, motionFromVector(pair % 100 < 50 ? curve : Vector6d(-curve)));
    Eigen::Matrix<double, 12, 12> all;
    all << known.pose, known.pose_and_drift, known.pose_and_drift.transpose(), known.drift;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> solver(all);
    ASSERT_GT(solver.eigenvalues().minCoeff(), -1e-9 * solver.eigenvalues().maxCoeff()) << pair;
    const double now = known.pose.determinant();
    ASSERT_GT(now, volume) << pair;
    volume = now;
  }
}

}  // namespace

}  // namespace cartvo::vo
