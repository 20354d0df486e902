// What disparities tell of the rig: an information filter.
#include "vo_core/column_monitor.hpp"

#include <Eigen/LU>
#include <cmath>

#include "vo_core/dead_zone.hpp"

namespace cartvo {
namespace {

using Vector = RigCorrection::Vector;
using Matrix = RigCorrection::Matrix;

// In the order of RigCorrection: yaw (rad), bend (normalised).

// Standard deviations with which a calibration is taken to be known beforehand.
const Vector kPrior(1e-3, 3e-3);
constexpr double kMemory = 60.0;  // s, in which a pair's weight falls to 1/e
// Errors of neighbouring pairs hang together, for landmarks last: a pair counts for a tenth of a pair.
constexpr double kShare = 0.1;
// Below this, an estimate is as likely the estimator's own bias (some hundredths of a pixel) as the rig's.
constexpr double kDeadYaw = 3e-5, kDeadBend = 3e-5;
// No more is corrected than a rig may have come to by heat and shaking; what is worse wants a calibration.
constexpr double kMostYaw = 1e-2, kMostBend = 3e-3;

Matrix priorInformation() {
  return kPrior.cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace

ColumnMonitor::ColumnMonitor() : information_(priorInformation()) {}

void ColumnMonitor::add(const Matrix& information, const Vector& gradient, const RigCorrection& applied,
                        double time_step) {
  // What the pair says is about what was applied to it, which the dead zone and the bounds keep from the
  // estimate.
  const Vector about_estimate = gradient - information * (estimate_ - Vector(applied.yaw, applied.bend));
  const double kept = std::exp(-time_step / kMemory);
  const Matrix sum = kept * information_ + (1.0 - kept) * priorInformation() + kShare * information;
  const Vector change = sum.inverse() * (kShare * about_estimate);
  if (!change.allFinite()) return;
  information_ = sum;
  estimate_ += change;
  // What was gathered with a rig in mind that is far from this one was seen through wrong depths.
  if (((estimate_ - gathered_about_).array().abs() > kPrior.array()).any()) {
    gathered_about_ = estimate_;
    information_ = priorInformation();
  }
}

void ColumnMonitor::turn(double yaw) {
  estimate_[0] += yaw;
  gathered_about_ = estimate_;
  information_ = priorInformation();
}

Vector ColumnMonitor::deviation() const {
  return information_.inverse().diagonal().cwiseSqrt();
}

RigCorrection ColumnMonitor::correction() const {
  RigCorrection correction;
  correction.yaw = beyondDeadZone(estimate_[0], kDeadYaw, kMostYaw);
  correction.bend = beyondDeadZone(estimate_[1], kDeadBend, kMostBend);
  return correction;
}

}  // namespace cartvo
