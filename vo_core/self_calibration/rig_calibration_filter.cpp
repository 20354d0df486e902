// Information filter for the errors of the rig's calibration.
#include "vo_core/self_calibration/rig_calibration_filter.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

constexpr int kRows = RowPatterns::kSize;

double square(double value) {
  return value * value;
}

double clampedTo(double value, double limit) {
  return std::clamp(value, -limit, limit);
}

/// rad/s, of the newest motion about the camera's y axis.
double yawRate(const BundleProblem& adjusted) {
  const TimedPose &before = adjusted.poses[adjusted.poses.size() - 2], &last = adjusted.poses.back();
  const double time = last.time - before.time;
  const Eigen::AngleAxisd turn((before.T_world_camera.inverse() * last.T_world_camera).linear());
  return time > 0.0 ? turn.angle() * turn.axis().y() / time : 0.0;
}

}  // namespace

RigCalibrationFilter::RigCalibrationFilter(const SelfCalibrationSettings& settings) : settings_(settings) {
  Vector stddev = Vector::Constant(settings.calibration_stddev);
  stddev[kSkew] = settings.skew_stddev;
  stddev[RowPatterns::kDelay] = settings.delay_stddev;
  prior_variances_ = stddev.cwiseAbs2();
  covariance_ = prior_variances_.asDiagonal();
}

void RigCalibrationFilter::predict(double time_step) {
  Vector drift = Vector::Constant(settings_.rotation_drift);
  drift[kSkew] = settings_.skew_drift;
  drift[RowPatterns::kDelay] = settings_.delay_drift;
  covariance_.diagonal() += time_step * drift.cwiseAbs2();
  pairs_ *= std::exp(-time_step / settings_.pattern_memory);
}

/// Updates with the equations, whose images share errors with others. A change beyond innovation_limit is
/// reduced to it, with its information.
void RigCalibrationFilter::update(const Equations& equations) {
  const double weight = 1.0 / settings_.correlated_pairs;
  const Matrix information = weight * equations.information;
  const Matrix after = (Matrix::Identity() + covariance_ * information).partialPivLu().solve(covariance_);
  const Vector change = weight * after * equations.gradient;
  if (!change.allFinite()) return;
  const Matrix by_pattern = weight * equations.pattern_variance * after * information * after;
  Vector innovation = Vector::Zero();
  for (int i = 0; i < kSize; ++i)
    if (const double variance = covariance_(i, i) - after(i, i) + by_pattern(i, i);
        variance > 1e-6 * covariance_(i, i))
      innovation[i] = change[i] / std::sqrt(variance);
  const double largest = innovation.cwiseAbs().maxCoeff();
  const double share = std::min(1.0, settings_.innovation_limit / std::max(largest, 1e-9));
  estimate_ += share * change;
  covariance_ += share * (after - covariance_);
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  mean_innovation_ += std::min(1.0, weight) * (share * innovation - mean_innovation_);
  for (const int angle : kAngles)
    if (std::abs(mean_innovation_[angle]) > settings_.bump_innovation) bump(angle);
}

void RigCalibrationFilter::bump(int index) {
  covariance_(index, index) += square(settings_.calibration_stddev);
  mean_innovation_[index] = 0.0;
}

RigCalibrationFilter::Equations RigCalibrationFilter::equationsOf(const RowMeasurement& rows) const {
  Eigen::Matrix<double, kRows, kSize> patterns = Eigen::Matrix<double, kRows, kSize>::Identity();
  patterns(RowPatterns::kCrossTerm, kYaw) = 1.0;
  patterns(RowPatterns::kCrossTerm, kP2) = 2.0;
  Equations equations;
  equations.information = patterns.transpose() * rows.information * patterns;
  equations.gradient = patterns.transpose() * rows.gradient;
  equations.pattern_variance = square(settings_.row_pattern) * rows.precision;
  return equations;
}

void RigCalibrationFilter::updateRows(const RowMeasurement& rows) {
  if (!(rows.precision > 0.0)) return;
  update(equationsOf(rows));
  pairs_ += 1.0;
  mean_products_ += (rows.mean_products - mean_products_) / pairs_;
}

void RigCalibrationFilter::updateDisparities(const BundleProblem& adjusted, const BundleResult& result,
                                             const RigCorrection& applied) {
  const Eigen::Isometry3d path =
      adjusted.poses.front().T_world_camera.inverse() * adjusted.poses.back().T_world_camera;
  if (path.translation().norm() < settings_.window_path) return;
  Eigen::Matrix<double, RigCorrection::kSize, kSize> observed =
      Eigen::Matrix<double, RigCorrection::kSize, kSize>::Zero();
  observed(0, kYaw) = observed(1, kP2) = 1.0;
  observed(0, RowPatterns::kDelay) = yawRate(adjusted);  // a camera that is exposed late has turned on
  const RigCorrection::Vector remaining =
      observed * estimate_ - RigCorrection::Vector(applied.yaw, applied.p2);
  Equations equations;
  equations.information = observed.transpose() * result.rig_information * observed;
  equations.gradient = observed.transpose() * (result.rig_gradient - result.rig_information * remaining);
  update(equations);
}

void RigCalibrationFilter::reinitialisePitch(const EstimateWithStddev& pitch) {
  for (const int angle : {int{RowPatterns::kRoll}, int{kYaw}})
    bump(angle);
  setState(RowPatterns::kPitch, pitch);
}

void RigCalibrationFilter::setState(int index, const EstimateWithStddev& state) {
  estimate_[index] = state.value;
  covariance_.row(index).setZero();
  covariance_.col(index).setZero();
  covariance_(index, index) = square(state.stddev);
}

void RigCalibrationFilter::set(const RigStates& states) {
  setState(RowPatterns::kPitch, states.pitch);
  setState(RowPatterns::kRoll, states.roll);
  // A short way shows no yaw: the estimate wanders, and the search for matches would follow it.
  if (states.yaw.stddev < settings_.yaw_pattern_stddev) setState(kYaw, states.yaw);
}

RigStates RigCalibrationFilter::states() const {
  const auto state = [&](int index) {
    return EstimateWithStddev{estimate_[index], std::sqrt(covariance_(index, index))};
  };
  return {state(RowPatterns::kPitch), state(kYaw), state(RowPatterns::kRoll)};
}

RowPatterns::Vector RigCalibrationFilter::expectedRows(const RigCorrection& applied) const {
  RowPatterns::Vector expected = estimate_.head<kRows>();
  expected[RowPatterns::kPitch] -= applied.pitch;
  expected[RowPatterns::kRoll] -= applied.roll;
  expected[RowPatterns::kCrossTerm] += estimate_[kYaw] - applied.yaw + 2.0 * (estimate_[kP2] - applied.p2);
  return expected;
}

RigCorrection RigCalibrationFilter::limited(RigCorrection correction) const {
  for (double* angle : {&correction.yaw, &correction.pitch, &correction.roll})
    *angle = clampedTo(*angle, settings_.maximum_rotation);
  correction.p2 = clampedTo(correction.p2, settings_.maximum_p2);
  return correction;
}

RigCorrection RigCalibrationFilter::expected() const {
  return limited({estimate_[kYaw], 0.0, estimate_[RowPatterns::kPitch], estimate_[RowPatterns::kRoll]});
}

RigCorrection RigCalibrationFilter::correction() const {
  Vector variances = covariance_.diagonal();
  variances.head<kRows>() += patternVariances();
  const auto significant = [&](int index) { return shrunk(estimate_[index], variances[index]); };
  return limited({significant(kYaw), significant(kP2), significant(RowPatterns::kPitch),
                  significant(RowPatterns::kRoll)});
}

/// Variances that a row pattern that is not estimated adds to those of the estimated ones.
RowPatterns::Vector RigCalibrationFilter::patternVariances() const {
  if (!(pairs_ > 0.0)) return RowPatterns::Vector::Zero();
  RowPatterns::Matrix information = mean_products_ / square(settings_.row_pattern);
  information.diagonal() += prior_variances_.head<kRows>().cwiseInverse();
  return information.inverse().diagonal();
}

RigCalibrationError RigCalibrationFilter::error() const {
  Vector variances = covariance_.diagonal();
  variances.head<kRows>() += patternVariances();
  const double uncorrected = estimate_[kYaw] - clampedTo(estimate_[kYaw], settings_.maximum_rotation);
  variances[kYaw] +=
      square(settings_.yaw_pattern_stddev) + square(settings_.uncorrected_yaw_share * uncorrected);
  const auto estimate = [&](int index) {
    return EstimateWithStddev{estimate_[index], std::sqrt(variances[index])};
  };
  const auto observability = [&](int index) {
    return std::clamp(1.0 - variances[index] / prior_variances_[index], 0.0, 1.0);
  };
  return {estimate(RowPatterns::kPitch),
          estimate(kYaw),
          estimate(RowPatterns::kRoll),
          estimate(RowPatterns::kDelay),
          {observability(RowPatterns::kPitch), observability(kYaw), observability(RowPatterns::kRoll),
           observability(RowPatterns::kDelay)}};
}

}  // namespace cartvo::vo
