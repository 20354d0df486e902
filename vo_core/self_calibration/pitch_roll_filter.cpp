// Information filter for pitch, roll and delay of the right camera.
#include "vo_core/self_calibration/pitch_roll_filter.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "vo_core/self_calibration/dead_zone.hpp"
#include "vo_core/self_calibration/row_filter_settings.hpp"

namespace cartvo::vo {
namespace {

using Vector = RowErrors::Vector;
using Matrix = RowErrors::Matrix;

// In the order of RowErrors: pitch, roll, cross term (rad), delay (s).

const Vector kPriorStddev(kRotationPriorStddev, kRotationPriorStddev, kCrossTermPriorStddev,
                          kDelayPriorStddev);
constexpr double kSearchStddev = 1e-3;  // rad, of a pitch found by the coarse search
// rad; less is not corrected: it is as likely the lens's as the rotation's, and has no effect.
constexpr double kDeadZone = 5e-4;
constexpr double kExpectedSignificance = 2.0, kCorrectedSignificance = 3.0;  // standard deviations
// A cross term that differs by this (rad, and standard deviations by the noise of the matches) from its mean
// over the last minute (s) is a yaw.
constexpr double kMinimumYawStep = 1e-3, kYawStepSignificance = 5.0;
constexpr double kUsualMemory = 60.0;
constexpr double kPairsToSettle = 30.0;
constexpr double kMaximumAngle = 1e-2;  // rad; more requires a new calibration

Matrix informationOf(const Vector& stddev) {
  return stddev.cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace

PitchRollFilter::PitchRollFilter() : information_(informationOf(kPriorStddev)) {}

void PitchRollFilter::update(const RowMeasurement& measurement, const RigCorrection& applied,
                             double time_step) {
  const double kept = std::exp(-time_step / kRowMemory);
  const Matrix predicted = kept * information_ + (1.0 - kept) * informationOf(kPriorStddev);
  const Matrix sum = predicted + kRowPairWeight * measurement.information;
  const Vector measured =
      measurement.errors + Vector(applied.pitch, applied.roll, applied.yaw + 2.0 * applied.p2, 0.0);
  const Vector change = sum.inverse() * (kRowPairWeight * measurement.information * (measured - estimate_));
  if (!change.allFinite()) return;
  information_ = sum;
  estimate_ += change;
  sum_of_products_ = kept * sum_of_products_ + measurement.mean_products;
  pairs_ = kept * pairs_ + 1.0;
  const double cross_term = estimate_[RowErrors::kCrossTerm];
  if (usual_cross_term_)
    *usual_cross_term_ += (1.0 - std::exp(-time_step / kUsualMemory)) * (cross_term - *usual_cross_term_);
  else if (pairs_ > kPairsToSettle)
    usual_cross_term_ = cross_term;
}

double PitchRollFilter::takeYawStep() {
  if (!usual_cross_term_) return 0.0;
  const double step = estimate_[RowErrors::kCrossTerm] - *usual_cross_term_;
  const double noise = std::sqrt(information_.inverse()(RowErrors::kCrossTerm, RowErrors::kCrossTerm));
  if (std::abs(step) < std::max(kMinimumYawStep, kYawStepSignificance * noise)) return 0.0;
  *usual_cross_term_ += step;
  information_ = informationOf(kPriorStddev);  // the old one is from before the step
  return step;
}

void PitchRollFilter::reinitialisePitch(double pitch) {
  reinitialisePitch(pitch, kSearchStddev);
}

void PitchRollFilter::reinitialisePitch(double pitch, double stddev) {
  estimate_[RowErrors::kPitch] += pitch;
  Vector stddevs = kPriorStddev;
  stddevs[RowErrors::kPitch] = stddev;
  information_ = informationOf(stddevs);
}

void PitchRollFilter::reinitialisePitch(const RowMeasurement& measurement) {
  const double information = measurement.information(RowErrors::kPitch, RowErrors::kPitch);
  if (!(information > 0.0)) return;
  reinitialisePitch(measurement.errors[RowErrors::kPitch] - estimate_[RowErrors::kPitch],
                    std::max(kSearchStddev, 1.0 / std::sqrt(information)));
  update(measurement, {}, 0.0);
}

Vector PitchRollFilter::stddev() const {
  Matrix covariance = information_.inverse();
  if (pairs_ > 0.0) {
    const Matrix mean = sum_of_products_ / pairs_;
    covariance += (mean / (kUnmodelledRows * kUnmodelledRows) + informationOf(kPriorStddev)).inverse();
  }
  return covariance.diagonal().cwiseSqrt();
}

RigCorrection PitchRollFilter::correctionBeyond(const Vector& dead_zone) const {
  RigCorrection correction;
  correction.pitch = applyDeadZone(estimate_[RowErrors::kPitch], dead_zone[RowErrors::kPitch], kMaximumAngle);
  correction.roll = applyDeadZone(estimate_[RowErrors::kRoll], dead_zone[RowErrors::kRoll], kMaximumAngle);
  return correction;
}

RigCorrection PitchRollFilter::expected() const {
  return correctionBeyond((kExpectedSignificance * stddev()).cwiseMax(kDeadZone));
}

RigCorrection PitchRollFilter::correction() const {
  return correctionBeyond((kCorrectedSignificance * stddev()).cwiseMax(kDeadZone));
}

}  // namespace cartvo::vo
