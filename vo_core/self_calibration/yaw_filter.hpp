#pragma once

#include "vo_core/geometry/rig_correction.hpp"

namespace cartvo::vo {

/// Information filter for the right camera's yaw (rad) and p2 (normalised), measured by disparities.
class YawFilter {
 public:
  YawFilter();

  /// Updates with the `information` and `gradient` of one pair (BundleResult), whose disparities were
  /// corrected by `applied`. `time_step`: s since the previous pair.
  void update(const RigCorrection::Matrix& information, const RigCorrection::Vector& gradient,
              const RigCorrection& applied, double time_step);

  /// Adds a turn of the right camera in yaw (rad), as detected from the rows
  /// (PitchRollFilter::takeYawStep()); discards older information.
  void applyYawStep(double yaw);

  /// Total error of the calibration, before correction, and its standard deviation.
  const RigCorrection::Vector& estimate() const { return estimate_; }
  RigCorrection::Vector stddev() const;

  /// Yaw and p2 to correct: the estimate after a dead zone for the errors that every calibration leaves,
  /// limited.
  RigCorrection correction() const;

 private:
  RigCorrection::Vector estimate_ = RigCorrection::Vector::Zero();
  RigCorrection::Matrix information_;
  RigCorrection::Vector linearisation_ = RigCorrection::Vector::Zero();  ///< estimate when information_ began
};

}  // namespace cartvo::vo
