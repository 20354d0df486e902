// Extrapolates mean velocities to the instant of the exposure.
#include "pipeline/velocity_at_exposure.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::pipeline {
namespace {

constexpr double kForgettingFactor = 0.9;     // per pair
constexpr double kInitialAcceleration = 2.5;  // m/s^2 and rad/s^2, prior standard deviation: a lively cart
constexpr double kInitialJerk = 20.0;         // m/s^3 and rad/s^3, the same

/// Second moment without the variance of the noise, axis by axis; correlations are kept.
vo::Matrix6d withoutNoise(const vo::Matrix6d& moment, const vo::Vector6d& noise) {
  const vo::Vector6d part =
      (1.0 - noise.array() / moment.diagonal().array().max(1e-12)).max(0.0).sqrt().matrix();
  return part.asDiagonal() * moment * part.asDiagonal();
}

/// The prior counts as the first of the values.
void updateMoment(Moment& moment, const vo::Vector6d& value) {
  moment.values += 1.0;
  const double weight = std::max(1.0 - kForgettingFactor, 1.0 / moment.values);
  moment.mean += weight * (value * value.transpose() - moment.mean);
}

}  // namespace

VelocityAtExposure::VelocityAtExposure()
    : acceleration_moment_{vo::Matrix6d::Identity() * kInitialAcceleration * kInitialAcceleration},
      jerk_moment_{vo::Matrix6d::Identity() * kInitialJerk * kInitialJerk} {}

Twist VelocityAtExposure::extrapolate(const Twist& mean, double time_step) {
  // Variance of a pose's error over h^2; the mean contains it twice.
  const vo::Vector6d noise = 0.5 * mean.covariance.diagonal();
  std::optional<vo::Vector6d> slope;
  double between = time_step;  // from the middle of the last time step to that of this one
  if (last_) {
    between = 0.5 * (time_step + last_->time_step);
    slope = (mean.value - last_->value) / between;
    updateMoment(acceleration_moment_, *slope);
    if (last_slope_) updateMoment(jerk_moment_, (*slope - *last_slope_) / between);
  }
  const double ahead = 0.5 * time_step;  // from the middle of the time step to the exposure
  const vo::Vector6d slope_noise = 6.0 * noise / (between * between);
  const vo::Vector6d jerk_noise = 20.0 * noise / std::pow(between, 4);
  const Eigen::Array<double, 6, 1> ratio =
      acceleration_moment_.mean.diagonal().array() / slope_noise.array().max(1e-12);
  vo::Vector6d part = (1.0 - 2.0 / ratio.max(2.0)).matrix();
  if (!slope) part.setZero();

  Twist now;
  now.value = mean.value;
  if (slope) now.value += ahead * part.cwiseProduct(*slope);
  const Eigen::Array<double, 6, 1> a = part.array();
  const vo::Vector6d growth =
      (0.5 * ((1.0 + 0.5 * a).square() + (1.0 + a).square() + 0.25 * a.square())).sqrt().matrix();
  const vo::Vector6d not_extrapolated = ahead * (1.0 - a).matrix();
  // With a constant jerk j, linear extrapolation over the time step h has the error j h^2 / 3.
  const vo::Vector6d jerk_gain = (time_step * time_step / 3.0) * part;
  now.covariance = growth.asDiagonal() * mean.covariance * growth.asDiagonal();
  now.covariance += not_extrapolated.asDiagonal() * withoutNoise(acceleration_moment_.mean, slope_noise) *
                    not_extrapolated.asDiagonal();
  now.covariance +=
      jerk_gain.asDiagonal() * withoutNoise(jerk_moment_.mean, jerk_noise) * jerk_gain.asDiagonal();

  last_ = Mean{mean.value, time_step};
  last_slope_ = slope;
  return now;
}

void VelocityAtExposure::setStandstill(double time_step) {
  last_ = Mean{vo::Vector6d::Zero(), time_step};
  last_slope_.reset();
}

void VelocityAtExposure::reset() {
  last_.reset();
  last_slope_.reset();
}

}  // namespace cartvo::pipeline
