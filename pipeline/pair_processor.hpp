#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "calib/model/rig.hpp"
#include "calib/rectification/rectification.hpp"
#include "capture/pair_synchroniser.hpp"
#include "pipeline/body_motion.hpp"
#include "pipeline/pair_view.hpp"
#include "pipeline/picture_light.hpp"
#include "pipeline/protection_level.hpp"
#include "pipeline/shutters.hpp"
#include "pipeline/stage_clock.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/stereo_odometry.hpp"

// Processing of one pair: rectification, odometry, motion of the body and its bounds.

namespace cartvo::calib {
class Rectifier;
}  // namespace cartvo::calib

namespace cartvo::pipeline {

/// The camera of the rectified images, for StereoOdometry.
vo::StereoCamera stereoCamera(const calib::Rectification& rectification);

/// Result of processing one pair of frames.
struct PairResult {
  std::uint64_t sequence = 0;  ///< counts the processed pairs from 0
  capture::FrameTimestamps left;
  capture::FrameTimestamps right;
  vo::OdometryEstimate estimate;  ///< of the rectified left camera
  int features = 0;               ///< target number
  BodyMotion motion;              ///< of the cart's body; velocities at the exposure (estimate.twist, else
                                  ///< VelocityAtExposure), NaN if a bound exceeds its alert limit
  ProtectionLevel level;          ///< of `motion`
  std::optional<LimitedBound> worst;  ///< of `level`; empty if there is no estimate
  StageTimes times;
  /// Of the left and the right raw picture; measured every 0.4 s, empty in between.
  std::optional<std::array<PictureLight, 2>> light;

  /// Whether a bound exceeds its alert limit.
  bool exceedsAlertLimit() const { return worst && worst->isExceeded(); }
  /// Whether velocities and pose are published as VALID: they are known, and well enough.
  bool isValid() const {
    return estimate.valid && worst && !worst->isExceeded() && motion.velocity.allFinite() &&
           motion.angular_velocity.allFinite();
  }
  /// Right minus left exposure, ns.
  std::int64_t offset_ns() const { return right.exposure_ns - left.exposure_ns; }
  /// Offset minus the difference of the minimum-delay arrival times, ns; meaningful for live cameras only.
  std::int64_t appliedCorrectionNs() const {
    return offset_ns() - (right.min_delay_arrival_ns - left.min_delay_arrival_ns);
  }
  /// Arrival of the pair's last packet, ns since the Unix epoch.
  std::int64_t arrival_ns() const { return std::max(left.arrival_ns, right.arrival_ns); }
};

/// Settings of a PairProcessor.
struct PairProcessorSettings {
  vo::OdometrySettings odometry{};
  /// For a camera whose readout the rig does not state.
  AbsentReadout absent_readout = AbsentReadout::global_shutter;
  AlertLimits alert_limits{};
};

/// Processes a pair: rectification, odometry, motion of the body. Used for live cameras and replay alike.
/// Deterministic; not thread-safe.
class PairProcessor {
 public:
  /// `rectifier`: built for `rig` (loadOrBuildTables). Throws what the odometry throws.
  PairProcessor(const calib::Rig& rig, calib::Rectifier rectifier, const PairProcessorSettings& settings);
  ~PairProcessor();
  PairProcessor(PairProcessor&&) noexcept;
  PairProcessor& operator=(PairProcessor&&) noexcept;

  PairResult process(const capture::FramePair& pair);

  /// Sets the target number of features from the next pair on.
  void setTargetFeatureCount(int features);
  int features() const;

  /// Asks `viewer`, which must outlive the processing, whether to copy each pair for a display.
  void setViewer(PairViewer& viewer);

  const calib::Rectifier& rectifier() const;

  /// Rotation from the rectified left camera to the rig's left camera.
  Eigen::Isometry3d T_left_rectified() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::pipeline
