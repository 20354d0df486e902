// From means over the time step to the instant of the exposure.
#include "daemon/velocity_at_exposure.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {
namespace {

constexpr double kMemory = 0.9;             // of what has been seen, from pair to pair
constexpr double kFirstAcceleration = 2.0;  // m/s^2 and rad/s^2, expected before anything has been seen
constexpr double kFirstJerk = 20.0;         // m/s^3 and rad/s^3

/// The part of a mean of outer products that noise does not explain, axis by axis; correlations stay.
Matrix6d beyondNoise(const Matrix6d& seen, const Vector6d& noise) {
  const Vector6d part = (1.0 - noise.array() / seen.diagonal().array().max(1e-12)).max(0.0).sqrt().matrix();
  return part.asDiagonal() * seen * part.asDiagonal();
}

void remember(Matrix6d& mean, const Vector6d& value) {
  mean = kMemory * mean + (1.0 - kMemory) * value * value.transpose();
}

}  // namespace

VelocityAtExposure::VelocityAtExposure()
    : changes_(Matrix6d::Identity() * kFirstAcceleration * kFirstAcceleration),
      bends_(Matrix6d::Identity() * kFirstJerk * kFirstJerk) {}

Twist VelocityAtExposure::next(const Twist& mean, double time_step) {
  // Variance of a pose's error over h^2, which the mean has twice.
  const Vector6d noise = 0.5 * mean.covariance.diagonal();
  std::optional<Vector6d> slope;
  double between = time_step;  // from the middle of the last time step to that of this one
  if (last_) {
    between = 0.5 * (time_step + last_->time_step);
    slope = (mean.value - last_->value) / between;
    remember(changes_, *slope);
    if (last_slope_) remember(bends_, (*slope - *last_slope_) / between);
  }
  const double ahead = 0.5 * time_step;  // from the middle of the time step to the exposure
  const Vector6d slope_noise = 6.0 * noise / (between * between);
  const Vector6d bend_noise = 20.0 * noise / std::pow(between, 4);
  const Eigen::Array<double, 6, 1> ratio = changes_.diagonal().array() / slope_noise.array().max(1e-12);
  Vector6d part = (1.0 - 2.0 / ratio.max(2.0)).matrix();
  if (!slope) part.setZero();

  Twist now;
  now.value = mean.value;
  if (slope) now.value += ahead * part.cwiseProduct(*slope);
  const Eigen::Array<double, 6, 1> a = part.array();
  const Vector6d growth =
      (0.5 * ((1.0 + 0.5 * a).square() + (1.0 + a).square() + 0.25 * a.square())).sqrt().matrix();
  const Vector6d kept_back = ahead * (1.0 - a).matrix();
  // A mean slope that itself changes is, at the exposure, off by the third of that over a time step squared.
  const Vector6d bent = (time_step * time_step / 3.0) * part;
  now.covariance = growth.asDiagonal() * mean.covariance * growth.asDiagonal();
  now.covariance += kept_back.asDiagonal() * beyondNoise(changes_, slope_noise) * kept_back.asDiagonal();
  now.covariance += bent.asDiagonal() * beyondNoise(bends_, bend_noise) * bent.asDiagonal();

  last_ = Mean{mean.value, time_step};
  last_slope_ = slope;
  return now;
}

void VelocityAtExposure::stand(double time_step) {
  last_ = Mean{Vector6d::Zero(), time_step};
  last_slope_.reset();
}

void VelocityAtExposure::forget() {
  last_.reset();
  last_slope_.reset();
}

}  // namespace cartvo
