// What rows tell of the rig: an information filter with a short memory.
#include "vo_core/row_monitor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "vo_core/dead_zone.hpp"

namespace cartvo {
namespace {

using Vector = RowErrors::Vector;
using Matrix = RowErrors::Matrix;

// In the order of RowErrors: pitch, roll, keystone (rad), delay (s).

// Standard deviations with which a calibration and instants are taken to be known beforehand.
const Vector kPrior(3e-3, 3e-3, 1e-2, 1e-2);
constexpr double kSuspicion = 1e-3;  // rad, of a pitch found by other means
constexpr double kMemory = 10.0;     // s, in which a pair's weight falls to 1/e
// Errors of neighbouring pairs hang together, for landmarks last: a pair counts for a tenth of a pair.
constexpr double kShare = 0.1;
// px, rms: what a good calibration leaves over in the rows in patterns that are not among the errors. It does
// not average out, however many pairs there are. KITTI's rows would not have a delay of 0.4 ms without it.
constexpr double kUnmodelled = 0.03;
// What is less is not corrected: as likely the lens's as the rotation's, and of no consequence.
constexpr double kDead = 5e-4;                       // rad
constexpr double kLikely = 2.0, kBeyondDoubt = 3.0;  // standard deviations
// A keystone that changes by so much (rad, and standard deviations by the matches' noise) against that of the
// last minute (s) is a yaw.
constexpr double kTurn = 1e-3, kTurnBeyondDoubt = 5.0;
constexpr double kUsual = 60.0;
constexpr double kPairsToSettle = 30.0;
constexpr double kMost = 1e-2;  // rad; what is worse wants a calibration

Matrix informationOf(const Vector& deviations) {
  return deviations.cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace

RowMonitor::RowMonitor() : information_(informationOf(kPrior)) {}

void RowMonitor::add(const RowEvidence& evidence, const RigCorrection& applied, double time_step) {
  const double kept = std::exp(-time_step / kMemory);
  const Matrix expected = kept * information_ + (1.0 - kept) * informationOf(kPrior);
  const Matrix sum = expected + kShare * evidence.information;
  const Vector found =
      evidence.errors + Vector(applied.pitch, applied.roll, applied.yaw + 2.0 * applied.bend, 0.0);
  const Vector change = sum.inverse() * (kShare * evidence.information * (found - estimate_));
  if (!change.allFinite()) return;
  information_ = sum;
  estimate_ += change;
  leverage_ = kept * leverage_ + evidence.leverage;
  pairs_ = kept * pairs_ + 1.0;
  const double keystone = estimate_[RowErrors::kKeystone];
  if (usual_keystone_)
    *usual_keystone_ += (1.0 - std::exp(-time_step / kUsual)) * (keystone - *usual_keystone_);
  else if (pairs_ > kPairsToSettle)
    usual_keystone_ = keystone;
}

double RowMonitor::takeTurn() {
  if (!usual_keystone_) return 0.0;
  const double turn = estimate_[RowErrors::kKeystone] - *usual_keystone_;
  const double noise = std::sqrt(information_.inverse()(RowErrors::kKeystone, RowErrors::kKeystone));
  if (std::abs(turn) < std::max(kTurn, kTurnBeyondDoubt * noise)) return 0.0;
  *usual_keystone_ += turn;
  information_ = informationOf(kPrior);  // of before
  return turn;
}

void RowMonitor::suspectPitch(double pitch) {
  suspectPitch(pitch, kSuspicion);
}

void RowMonitor::suspectPitch(double pitch, double deviation) {
  estimate_[RowErrors::kPitch] += pitch;
  Vector deviations = kPrior;
  deviations[RowErrors::kPitch] = deviation;
  information_ = informationOf(deviations);
}

void RowMonitor::suspectPitch(const RowEvidence& evidence) {
  const double information = evidence.information(RowErrors::kPitch, RowErrors::kPitch);
  if (!(information > 0.0)) return;
  suspectPitch(evidence.errors[RowErrors::kPitch] - estimate_[RowErrors::kPitch],
               std::max(kSuspicion, 1.0 / std::sqrt(information)));
  add(evidence, {}, 0.0);
}

Vector RowMonitor::deviation() const {
  Matrix covariance = information_.inverse();
  if (pairs_ > 0.0) {
    const Matrix mean = leverage_ / pairs_;
    covariance += (mean / (kUnmodelled * kUnmodelled) + informationOf(kPrior)).inverse();
  }
  return covariance.diagonal().cwiseSqrt();
}

RigCorrection RowMonitor::beyond(const Vector& dead) const {
  RigCorrection correction;
  correction.pitch = beyondDeadZone(estimate_[RowErrors::kPitch], dead[RowErrors::kPitch], kMost);
  correction.roll = beyondDeadZone(estimate_[RowErrors::kRoll], dead[RowErrors::kRoll], kMost);
  return correction;
}

RigCorrection RowMonitor::expected() const {
  return beyond((kLikely * deviation()).cwiseMax(kDead));
}

RigCorrection RowMonitor::correction() const {
  return beyond((kBeyondDoubt * deviation()).cwiseMax(kDead));
}

}  // namespace cartvo
