#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "calib/rig.hpp"
#include "capture/pair_synchroniser.hpp"
#include "daemon/body_motion.hpp"
#include "daemon/stage_clock.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// All that one pair of frames told. Instants: ns since the Unix epoch.
struct PairResult {
  std::uint64_t sequence = 0;  ///< counts the processed pairs from 0
  std::int64_t left_exposure_ns = 0;
  std::int64_t right_exposure_ns = 0;
  std::int64_t arrival_ns = 0;  ///< the later of the two frames' last packets
  std::int64_t decoded_ns = 0;  ///< both pictures were ready
  std::uint64_t left_sequence = 0;
  std::uint64_t right_sequence = 0;
  OdometryEstimate estimate;  ///< of the rectified left camera
  BodyMotion motion;          ///< of the cart's body
  StageTimes times;

  /// Right minus left exposure, ns.
  std::int64_t offset_ns() const { return right_exposure_ns - left_exposure_ns; }
};

/// The stages of one pair after pairing: rectification, odometry, motion of the body. The same for live
/// cameras and replay. Deterministic; not thread-safe.
class PairProcessor {
 public:
  /// `tables_file`: where the rectification tables are kept; computed, but not kept, if empty.
  /// Throws what the tables and the odometry throw.
  PairProcessor(const Rig& rig, const std::filesystem::path& tables_file, const OdometrySettings& settings);
  ~PairProcessor();
  PairProcessor(PairProcessor&&) noexcept;
  PairProcessor& operator=(PairProcessor&&) noexcept;

  PairResult process(const FramePair& pair);

  /// Turns the axes of the rectified left camera into those of the rig's left camera.
  const Eigen::Isometry3d& T_left_rectified() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
