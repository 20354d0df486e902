#pragma once

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/column_monitor.hpp"
#include "vo_core/rig_check.hpp"
#include "vo_core/row_monitor.hpp"

namespace cartvo {

/// What driving tells of the rig: yaw and bend from disparities, pitch, roll and delay from rows.
class RigMonitor {
 public:
  /// Takes in the newest pair of an adjusted problem, whose right pixels had been corrected by `applied`.
  /// `way`: m driven within the window; what disparities tell of the rig shows by driving only. `time_step`:
  /// s since the pair before.
  void add(const BundleProblem& adjusted, const BundleResult& result, const RigCorrection& applied,
           double way, double time_step);

  /// The right camera was found to look up by so much more than is known (rad), roughly and by other means.
  void suspectPitch(double pitch) { rows_.suspectPitch(pitch); }

  /// What is to be corrected, of rotation and bend.
  RigCorrection correction() const;

  /// From the right camera's axes as they are, as far as is known, to those of the rig file: where matches
  /// are to be looked for.
  Eigen::Matrix3d expectedRotation() const;

  /// `applied`: what is corrected at present.
  RigCheck check(const RigCorrection& applied) const;

 private:
  ColumnMonitor columns_;
  RowMonitor rows_;
};

}  // namespace cartvo
