#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "daemon/diagnostics/measurement_checks.hpp"
#include "daemon/diagnostics/stereo_match_monitor.hpp"
#include "pipeline/pair_processor.hpp"

namespace cartvo::daemon {

/// Reports gross faults of the rig, errors of the rig calibration and of the time offset that the odometry
/// has estimated, readouts that are not those of the rig, missing stereo matches, and regions of the picture
/// that have not moved with the scene for 20 s. An error is reported while it is significant (3 standard
/// deviations) and large enough to matter, until it is clearly smaller. Not thread-safe.
class SelfCheck {
 public:
  /// `readouts`: of the rig file or the configuration.
  explicit SelfCheck(const StatedReadouts& readouts = {}) : readouts_(readouts) {}

  void update(const vo::OdometryEstimate& estimate);

  /// Whether the pictures have the texture by which left and right can be compared. Without it no gross fault
  /// and no missing matches are reported.
  void setTexture(bool suffices);

  /// Faults with their latest numbers and what to do; empty if there is none. A gross fault hides the others,
  /// which it may cause.
  std::string message() const;

  /// The gross fault, the missing matches or a part of the cart in the view, with which there is no odometry,
  /// and what to do; empty if there is none.
  std::string stereoFaultMessage() const;

  /// True once after each change of the set of faults.
  bool consumeChange();

  const std::optional<vo::RigCalibrationError>& rig() const { return rig_; }
  const std::optional<vo::ReadoutEstimates>& readouts() const { return readouts_.latest(); }

 private:
  static constexpr std::size_t kQuantities = 4;  ///< time offset, pitch, yaw, roll
  static constexpr double kPartShown = 0.5;      ///< share of pairs

  /// None while the texture does not suffice to tell.
  vo::StereoFault reportedFault() const { return texture_suffices_ ? stereo_fault_ : vo::StereoFault::none; }
  bool areMatchesMissing() const { return texture_suffices_ && matches_.matchesMissing(); }

  void updateRig(const vo::RigCalibrationError& rig);
  void updateStillRegions(const vo::OdometryEstimate& estimate);
  bool anglesCauseMissingMatches() const;
  std::string anglesMessage() const;
  std::string stillRegionsMessage() const;
  bool hidesPart() const { return part_share_ > kPartShown; }

  std::optional<vo::RigCalibrationError> rig_;
  std::array<bool, kQuantities> faulty_{};
  ReadoutCheck readouts_;
  StereoMatchMonitor matches_;
  vo::ImageRegions still_regions_;              ///< to report
  std::optional<std::int64_t> still_since_ns_;  ///< exposure of the first pair that had some; empty: none
  vo::StereoFault stereo_fault_ = vo::StereoFault::none;  ///< named, until a pair is VALID
  double part_share_ = 0.0;   ///< of the last pairs with OdometryEstimate::part_stands
  double valid_share_ = 1.0;  ///< of the last pairs
  bool texture_suffices_ = true;
  bool changed_ = false;
};

}  // namespace cartvo::daemon
