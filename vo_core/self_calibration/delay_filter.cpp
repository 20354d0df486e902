// Information filter for the delay of the right camera, with the errors of lens and baseline that resemble
// it.
#include "vo_core/self_calibration/delay_filter.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "vo_core/self_calibration/row_filter_settings.hpp"

namespace cartvo::vo {
namespace {

using Vector = RowPatterns::Vector;
using Matrix = RowPatterns::Matrix;

// Each coefficient of the lens: as p2's in YawFilter.
constexpr double kLensPriorStddev = 3e-3;
// s, time constant of the decay of information about lens and baseline, which stay as they are: YawFilter's.
constexpr double kFixedMemory = 60.0;

Matrix priorInformation() {
  Vector stddev = Vector::Constant(kRotationPriorStddev);  // also of the baseline's direction
  stddev[RowPatterns::kCrossTerm] = kCrossTermPriorStddev;
  stddev[RowPatterns::kDelay] = kDelayPriorStddev;
  stddev.segment<3>(RowPatterns::kRowScale).setConstant(kLensPriorStddev);
  return stddev.cwiseAbs2().cwiseInverse().asDiagonal();
}

/// Information after `time_step` (s): that about each error decays towards the prior with its own memory.
Matrix decayed(const Matrix& information, double time_step) {
  Vector kept = Vector::Constant(std::exp(-time_step / kFixedMemory));
  kept.head<RowErrors::kSize>().setConstant(std::exp(-time_step / kRowMemory));
  const Vector root = kept.cwiseSqrt();
  Matrix left = root.asDiagonal() * information * root.asDiagonal();
  left.diagonal() += (Vector::Ones() - kept).cwiseProduct(priorInformation().diagonal());
  return left;
}

}  // namespace

DelayFilter::DelayFilter() : information_(priorInformation()) {}

void DelayFilter::update(const RowMeasurement& measurement, const RigCorrection& applied, double time_step) {
  const RowEquations& equations = measurement.equations;
  Vector correction = Vector::Zero();
  correction[RowPatterns::kPitch] = applied.pitch;
  correction[RowPatterns::kRoll] = applied.roll;
  correction[RowPatterns::kCrossTerm] = applied.yaw + 2.0 * applied.p2;
  const Matrix sum = decayed(information_, time_step) + kRowPairWeight * equations.information;
  const Vector about_estimate = equations.gradient - equations.information * (estimate_ - correction);
  const Vector change = sum.ldlt().solve(kRowPairWeight * about_estimate);
  if (!change.allFinite()) return;
  information_ = sum;
  estimate_ += change;
  const double kept = std::exp(-time_step / kRowMemory);
  sum_of_products_ = kept * sum_of_products_ + equations.mean_products;
  pairs_ = kept * pairs_ + 1.0;
}

void DelayFilter::restart(double pitch) {
  estimate_[RowPatterns::kPitch] += pitch;
  information_ = priorInformation();
}

EstimateWithStddev DelayFilter::delay() const {
  constexpr int kDelay = RowPatterns::kDelay;
  const Vector unit = Vector::Unit(kDelay);
  double variance = information_.ldlt().solve(unit)[kDelay];
  if (pairs_ > 0.0) {
    const Matrix unmodelled =
        sum_of_products_ / (pairs_ * kUnmodelledRows * kUnmodelledRows) + priorInformation();
    variance += unmodelled.ldlt().solve(unit)[kDelay];
  }
  return {estimate_[kDelay], std::sqrt(variance)};
}

}  // namespace cartvo::vo
