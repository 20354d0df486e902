#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <memory>

#include "calib/rig.hpp"
#include "capture/pair_synchroniser.hpp"
#include "daemon/body_motion.hpp"
#include "daemon/stage_clock.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

class Rectifier;

/// When one frame was exposed, received and ready (see Frame), and its number.
struct FrameInstants {
  std::int64_t exposure_ns = 0;
  std::int64_t arrival_ns = 0;
  std::int64_t decoded_ns = 0;
  std::uint64_t sequence = 0;
  std::int64_t undelayed_arrival_ns = 0;
};

/// All that one pair of frames told.
struct PairResult {
  std::uint64_t sequence = 0;  ///< counts the processed pairs from 0
  FrameInstants left;
  FrameInstants right;
  OdometryEstimate estimate;  ///< of the rectified left camera
  int features = 0;           ///< that were aimed at
  BodyMotion motion;  ///< of the cart's body; its velocities are those at the exposure (VelocityAtExposure)
  StageTimes times;

  /// Right minus left exposure, ns.
  std::int64_t offset_ns() const { return right.exposure_ns - left.exposure_ns; }
  /// By how much that is more than undelayed arrival says, ns; only of live cameras.
  std::int64_t applied_ns() const {
    return offset_ns() - (right.undelayed_arrival_ns - left.undelayed_arrival_ns);
  }
  /// The last packet of the pair was received, ns since the Unix epoch.
  std::int64_t arrival_ns() const { return std::max(left.arrival_ns, right.arrival_ns); }
};

/// The stages of one pair after pairing: rectification, odometry, motion of the body. The same for live
/// cameras and replay. Deterministic; not thread-safe.
class PairProcessor {
 public:
  /// `rectifier` is the rig's (loadOrBuildTables). Throws what the odometry throws.
  PairProcessor(const Rig& rig, Rectifier rectifier, const OdometrySettings& settings);
  ~PairProcessor();
  PairProcessor(PairProcessor&&) noexcept;
  PairProcessor& operator=(PairProcessor&&) noexcept;

  PairResult process(const FramePair& pair);

  /// From the next pair on, aims at so many features (StereoOdometry::aimAt).
  void aimAt(int features);
  int features() const;

  const Rectifier& rectifier() const;

  /// Rotates the axes of the rectified left camera into those of the rig's left camera.
  Eigen::Isometry3d T_left_rectified() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
