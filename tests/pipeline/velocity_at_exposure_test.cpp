// Extrapolation of mean velocities to the instant of the exposure.

#include "pipeline/velocity_at_exposure.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

namespace cartvo::pipeline {
namespace {

constexpr double kStep = 1.0 / 18.0;  // s
constexpr double kPoseError = 2e-4;   // m and rad

/// Position and velocity along each axis over time.
struct Drive {
  std::function<double(double)> position;
  std::function<double(double)> velocity;
  double step = kStep;
};

struct Outcome {
  double nees = 0.0;                // per dimension, mean
  double mean_square = 0.0;         // of the extrapolated velocities' errors
  double mean_square_lagged = 0.0;  // of the mean velocities' errors
};

/// Measures poses at the end of each step with independent errors and extrapolates the mean velocities.
Outcome evaluate(const Drive& drive, int pairs, double pose_error) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, pose_error);
  const auto errors = [&] {
    vo::Vector6d e;
    for (int i = 0; i < 6; ++i)
      e[i] = normal(random);
    return e;
  };
  VelocityAtExposure velocity;
  Outcome outcome;
  vo::Vector6d before = errors();
  const int warm_up = 30;
  for (int i = 1; i <= pairs; ++i) {
    const double time = i * drive.step;
    const vo::Vector6d after = errors();
    Twist mean;
    mean.value =
        (vo::Vector6d::Constant(drive.position(time) - drive.position(time - drive.step)) + after - before) /
        drive.step;
    mean.covariance = vo::Matrix6d::Identity() * 2.0 * std::pow(std::max(pose_error, 1e-7) / drive.step, 2);
    before = after;
    const Twist now = velocity.extrapolate(mean, drive.step);
    if (i <= warm_up) continue;
    const vo::Vector6d truth = vo::Vector6d::Constant(drive.velocity(time));
    const vo::Vector6d error = now.value - truth;
    outcome.nees += error.dot(now.covariance.ldlt().solve(error)) / 6.0 / (pairs - warm_up);
    outcome.mean_square += error.squaredNorm() / 6.0 / (pairs - warm_up);
    outcome.mean_square_lagged += (mean.value - truth).squaredNorm() / 6.0 / (pairs - warm_up);
  }
  return outcome;
}

Drive swinging(double amplitude, double frequency) {
  const double w = 2.0 * M_PI * frequency;
  return {[=](double t) { return -amplitude / w * std::cos(w * t); },
          [=](double t) { return amplitude * std::sin(w * t); }};
}

TEST(VelocityAtExposure, IsExactForConstantAcceleration) {
  const Drive drive{[](double t) { return 0.5 * 2.0 * t * t; }, [](double t) { return 2.0 * t; }};
  const Outcome outcome = evaluate(drive, 60, 0.0);
  EXPECT_LT(std::sqrt(outcome.mean_square), 1e-3);
  EXPECT_GT(std::sqrt(outcome.mean_square_lagged), 0.05);  // m/s: half a time step of 2 m/s^2
}

TEST(VelocityAtExposure, IsNoNoisierThanMeanAtConstantVelocity) {
  const Drive drive{[](double t) { return 3.0 * t; }, [](double) { return 3.0; }};
  const Outcome outcome = evaluate(drive, 2000, kPoseError);
  EXPECT_LT(outcome.mean_square, 1.1 * outcome.mean_square_lagged);
  EXPECT_GT(outcome.nees, 0.7);
  EXPECT_LT(outcome.nees, 1.1);
}

TEST(VelocityAtExposure, ReducesLagOfSwingingCartWithConsistentCovariance) {
  for (const double frequency : {0.5, 1.0, 2.0}) {  // Hz, as a cart pitches and rolls
    const Outcome outcome = evaluate(swinging(0.3, frequency), 2000, kPoseError);
    EXPECT_LT(outcome.mean_square, 0.5 * outcome.mean_square_lagged) << frequency;
    EXPECT_GT(outcome.nees, 0.4) << frequency;
    EXPECT_LT(outcome.nees, 1.5) << frequency;
  }
}

TEST(VelocityAtExposure, IsMeanWithLargeCovarianceAfterReset) {
  VelocityAtExposure velocity;
  Twist mean;
  mean.covariance = vo::Matrix6d::Identity() * 1e-6;
  for (int i = 0; i < 10; ++i) {
    mean.value.setConstant(0.1 * i);
    velocity.extrapolate(mean, kStep);
  }
  velocity.reset();
  mean.value.setConstant(5.0);
  const Twist now = velocity.extrapolate(mean, kStep);
  EXPECT_EQ(now.value, mean.value);
  EXPECT_GT(now.covariance(0, 0), 10.0 * mean.covariance(0, 0));
}

TEST(VelocityAtExposure, ExtrapolatesFromZeroAfterStandstill) {
  VelocityAtExposure velocity;
  Twist mean;
  mean.covariance = vo::Matrix6d::Identity() * 1e-6;
  velocity.extrapolate(mean, kStep);
  velocity.setStandstill(kStep);
  mean.value.setConstant(0.05);
  EXPECT_GT(velocity.extrapolate(mean, kStep).value[0], 0.06);
}

}  // namespace
}  // namespace cartvo::pipeline
