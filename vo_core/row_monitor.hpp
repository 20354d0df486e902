#pragma once

#include <optional>

#include "vo_core/rig_correction.hpp"
#include "vo_core/row_evidence.hpp"

namespace cartvo {

/// Gathers, pair by pair, what the rows tell of the right camera, and forgets within some seconds: a bumped
/// camera is seen while it matters.
class RowMonitor {
 public:
  RowMonitor();

  /// `evidence`: of one pair, whose right pixels had been corrected by `applied`. `time_step`: s since the
  /// pair before.
  void add(const RowEvidence& evidence, const RigCorrection& applied, double time_step);

  /// The right camera was found to look up by so much more than is known (rad), roughly and by other means.
  void suspectPitch(double pitch);

  /// It is so by one pair's evidence, whatever was known before, to the degree that this tells.
  void suspectPitch(const RowEvidence& evidence);

  /// By how much yaw (rad) the right camera has turned lately; zero if it has not. What a keystone is by is
  /// not known, but lenses do not change from one minute to the next. Told once.
  double takeTurn();

  const RowErrors::Vector& estimate() const { return estimate_; }
  /// Standard deviation, by the matches' noise and by what a calibration leaves over in the rows.
  RowErrors::Vector deviation() const;

  /// Pitch and roll, where they are beyond doubt and more than any calibration leaves over, within bounds.
  RigCorrection correction() const;

  /// The same where they are likely but not beyond doubt: where matches are looked for.
  RigCorrection expected() const;

 private:
  void suspectPitch(double pitch, double deviation);
  RigCorrection beyond(const RowErrors::Vector& dead) const;

  RowErrors::Vector estimate_ = RowErrors::Vector::Zero();
  RowErrors::Matrix information_;
  RowErrors::Matrix leverage_ = RowErrors::Matrix::Zero();  ///< sum over pairs, as RowEvidence's
  double pairs_ = 0.0;                                      ///< in that sum
  std::optional<double> usual_keystone_;                    ///< nothing until there is one
};

}  // namespace cartvo
