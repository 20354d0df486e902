#pragma once

#include "vo_core/rig_correction.hpp"

namespace cartvo {

/// Gathers, pair by pair, what driving tells of the rig.
class RigMonitor {
 public:
  RigMonitor();

  /// `information`, `gradient`: of one pair (BundleResult), whose disparities had been corrected by
  /// `applied`.
  void add(const RigCorrection::Matrix& information, const RigCorrection::Vector& gradient,
           const RigCorrection& applied);

  /// What the calibration is off by.
  const RigCorrection::Vector& estimate() const { return estimate_; }
  RigCorrection::Vector deviation() const;

  /// What is to be corrected: the part of the estimate beyond what any calibration leaves over, within
  /// bounds.
  RigCorrection correction() const;

 private:
  RigCorrection::Vector estimate_ = RigCorrection::Vector::Zero();
  RigCorrection::Matrix information_;
};

}  // namespace cartvo
