#pragma once

#include "vo_core/rig_correction.hpp"

namespace cartvo {

/// Gathers, pair by pair, what disparities tell of the right camera's yaw and bend.
class ColumnMonitor {
 public:
  ColumnMonitor();

  /// `information`, `gradient`: of one pair (BundleResult), whose disparities had been corrected by
  /// `applied`. `time_step`: s since the pair before.
  void add(const RigCorrection::Matrix& information, const RigCorrection::Vector& gradient,
           const RigCorrection& applied, double time_step);

  /// The right camera was seen, by other means, to turn by so much yaw, rad: what was gathered is of before.
  void turn(double yaw);

  /// What the calibration is off by, and how well that is known from what has been gathered: the same error
  /// corrected, not as it stands.
  const RigCorrection::Vector& estimate() const { return estimate_; }
  RigCorrection::Vector deviation() const;

  /// Yaw and bend that are to be corrected: the part of the estimate beyond what any calibration leaves over,
  /// within bounds.
  RigCorrection correction() const;

 private:
  RigCorrection::Vector estimate_ = RigCorrection::Vector::Zero();
  RigCorrection::Matrix information_;
  RigCorrection::Vector gathered_about_ = RigCorrection::Vector::Zero();  ///< the estimate when that began
};

}  // namespace cartvo
