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
  /// `rows`: its rowEvidence(). `time_step`: s since the pair before.
  void add(const BundleProblem& adjusted, const BundleResult& result, const RowEvidence& rows,
           const RigCorrection& applied, double time_step);

  /// The right camera was found to look up by so much more than is known (rad), roughly and by other means.
  void suspectPitch(double pitch) { rows_.suspectPitch(pitch); }

  /// The same by the rows of one pair's stereo matches (matchesAlone()), none of them corrected: exactly.
  void suspectPitch(const BundleProblem& matches) { rows_.suspectPitch(rowEvidence(matches)); }

  /// What is to be corrected, of rotation and bend.
  RigCorrection correction() const;

  /// The same where it is likely but not beyond doubt: how the right camera is turned where matches are to
  /// be looked for. No bend.
  RigCorrection expected() const;

  RigCheck check() const;

 private:
  ColumnMonitor columns_;
  RowMonitor rows_;
};

}  // namespace cartvo
