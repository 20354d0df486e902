// Information filter for yaw and p2 of the right camera.
#include "vo_core/self_calibration/yaw_filter.hpp"

#include <Eigen/LU>
#include <cmath>

#include "vo_core/self_calibration/dead_zone.hpp"

namespace cartvo::vo {
namespace {

using Vector = RigCorrection::Vector;
using Matrix = RigCorrection::Matrix;

// In the order of RigCorrection::Vector: yaw (rad), p2 (normalised).

const Vector kPriorStddev(1e-3, 3e-3);  // of a calibration
constexpr double kMemory = 60.0;        // s, time constant of the decay of information
// Weight of a pair: errors of consecutive pairs are correlated because landmarks last about ten pairs.
constexpr double kPairWeight = 0.1;
// Dead zone: below, an estimate is as likely the estimator's own bias (some hundredths of a pixel).
constexpr double kYawDeadZone = 3e-5, kP2DeadZone = 3e-5;
// Limits of the correction: what heat and vibration may cause; more requires a new calibration.
constexpr double kMaximumYaw = 1e-2, kMaximumP2 = 3e-3;

Matrix priorInformation() {
  return kPriorStddev.cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace

YawFilter::YawFilter() : information_(priorInformation()) {}

void YawFilter::update(const Matrix& information, const Vector& gradient, const RigCorrection& applied,
                       double time_step) {
  // The gradient is at the applied correction, which the dead zone and the limits separate from the estimate.
  const Vector about_estimate = gradient - information * (estimate_ - Vector(applied.yaw, applied.p2));
  const double kept = std::exp(-time_step / kMemory);
  const Matrix sum = kept * information_ + (1.0 - kept) * priorInformation() + kPairWeight * information;
  const Vector change = sum.inverse() * (kPairWeight * about_estimate);
  if (!change.allFinite()) return;
  information_ = sum;
  estimate_ += change;
  // Information gathered about a distant estimate is based on wrong depths.
  if (((estimate_ - linearisation_).array().abs() > kPriorStddev.array()).any()) {
    linearisation_ = estimate_;
    information_ = priorInformation();
  }
}

void YawFilter::applyYawStep(double yaw) {
  estimate_[0] += yaw;
  linearisation_ = estimate_;
  information_ = priorInformation();
}

Vector YawFilter::stddev() const {
  return information_.inverse().diagonal().cwiseSqrt();
}

RigCorrection YawFilter::correction() const {
  RigCorrection correction;
  correction.yaw = applyDeadZone(estimate_[0], kYawDeadZone, kMaximumYaw);
  correction.p2 = applyDeadZone(estimate_[1], kP2DeadZone, kMaximumP2);
  return correction;
}

}  // namespace cartvo::vo
