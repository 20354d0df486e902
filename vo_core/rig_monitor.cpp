// What driving tells of the rig: an information filter.
#include "vo_core/rig_monitor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace cartvo {
namespace {

// Standard deviations with which a calibration is taken to be known beforehand.
constexpr double kPriorYaw = 1e-3;   // rad
constexpr double kPriorBend = 3e-3;  // normalised
// Errors of neighbouring pairs hang together, for landmarks last: a pair counts for a tenth of a pair.
constexpr double kShare = 0.1;
// Below this, an estimate is as likely the estimator's own bias (some hundredths of a pixel) as the rig's.
constexpr double kDeadYaw = 3e-5, kDeadBend = 3e-5;
// No more is corrected than a rig may have come to by heat and shaking; what is worse wants a calibration.
constexpr double kMostYaw = 2e-3, kMostBend = 3e-3;

/// Nothing in the dead zone, nearly all of what is far beyond it, no jump between: the non-negative garrote
/// (H. Gao, "Wavelet shrinkage denoising using the non-negative garrote", 1998).
double bounded(double value, double dead, double most) {
  const double size = std::abs(value);
  if (size <= dead) return 0.0;
  return std::copysign(std::min(size - dead * dead / size, most), value);
}

}  // namespace

RigMonitor::RigMonitor() {
  information_ =
      RigCorrection::Vector(1.0 / (kPriorYaw * kPriorYaw), 1.0 / (kPriorBend * kPriorBend)).asDiagonal();
}

void RigMonitor::add(const RigCorrection::Matrix& information, const RigCorrection::Vector& gradient,
                     const RigCorrection& applied) {
  // What the pair says is about what was applied to it, which the dead zone and the bounds keep from the
  // estimate.
  const RigCorrection::Vector about_estimate =
      gradient - information * (estimate_ - RigCorrection::Vector(applied.yaw, applied.bend));
  const RigCorrection::Matrix sum = information_ + kShare * information;
  const RigCorrection::Vector change = sum.inverse() * (kShare * about_estimate);
  if (!change.allFinite()) return;
  information_ = sum;
  estimate_ += change;
}

RigCorrection::Vector RigMonitor::deviation() const {
  return information_.inverse().diagonal().cwiseSqrt();
}

RigCorrection RigMonitor::correction() const {
  return {bounded(estimate_[0], kDeadYaw, kMostYaw), bounded(estimate_[1], kDeadBend, kMostBend)};
}

}  // namespace cartvo
