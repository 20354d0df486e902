#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <cartvo/odometry_t.hpp>

#include "capture/stereo_source.hpp"
#include "pipeline/pipeline.hpp"
#include "pipeline/source_rig.hpp"
#include "tools/replay/video_pair.hpp"
#include "tools/trajectory/trajectory.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// Source of a recording's timestamps.
enum class ReplayClock : std::uint8_t {
  configured,  ///< recomputed with the clock of the recording's configuration; without one as `recorded`
  recorded,    ///< timestamps of the live run
  automatic,   ///< recomputed with this ClockChoice, as are the following
  ntp,
  arrival,
  visual,
};
inline constexpr std::array<std::pair<const char*, ReplayClock>, 6> kReplayClocks{
    {{"configured", ReplayClock::configured},
     {"recorded", ReplayClock::recorded},
     {"auto", ReplayClock::automatic},
     {"ntp", ReplayClock::ntp},
     {"arrival", ReplayClock::arrival},
     {"visual", ReplayClock::visual}}};

/// Readouts that replace those of the rig and the configuration: s, left and right, as CameraModel::readout;
/// empty for an unknown one.
using ReplayReadouts = std::array<std::optional<double>, 2>;

struct ReplaySettings {
  std::filesystem::path source;
  std::filesystem::path right_video;  ///< video of the right camera; `source` is then the left camera's
  double frame_rate = 0.0;            ///< Hz; above 0 it replaces the time stamps of videos and times.txt
  bool side_by_side = false;          ///< each image of a folder contains both cameras' pictures
  std::optional<double>
      video_offset;           ///< s, added to the right video's times; empty: estimated from the images
  std::filesystem::path rig;  ///< empty: searched in the source's folder
  vo::OdometrySettings odometry;
  double folder_offset_stddev = 0.0;  ///< s, of the time offsets of pairs in an image folder
  ReplayClock clock = ReplayClock::configured;
  pipeline::PairViewer* viewer = nullptr;  ///< as replayPairs()'s
  std::optional<ReplayReadouts> readouts;  ///< empty: as the rig and the recording's configuration state
  std::optional<pipeline::AlertLimits>
      alert_limits;  ///< empty: of the recording's configuration, else defaults
};

/// Result of one pair.
struct ReplayedPair {
  std::int64_t exposure_ns = 0;  ///< of the left image
  std::int64_t offset_ns = 0;
  bool valid = false;  ///< as published: PairResult::isValid()
  vo::OdometryReasons reasons;
  vo::StereoFault stereo_fault = vo::StereoFault::none;
  std::uint32_t reset_counter = 0;
  double time_step = 0.0;  ///< s, duration of the motion; 0 if none was measured
  vo::FeatureCounts counts;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< as in BodyMotion; NaN if not valid
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< as in BodyMotion; NaN if not valid
  vo::Matrix6d twist_covariance = vo::Matrix6d::Zero();        ///< as in BodyMotion; NaN if not valid
  pipeline::ProtectionLevel level;                             ///< NaN if no motion was measured

  // The velocities and their covariance are as published and include the rig's scale uncertainty; the
  // following covariances do not. Poses and motions are those of the rig's left camera, in its own axes:
  // OdometryEstimate without the rotation of the rectification. Covariances are those of right perturbations,
  // in the axes of the current camera.
  /// Pose relative to the first pair, across epochs.
  Eigen::Isometry3d T_first_left = Eigen::Isometry3d::Identity();
  /// Pose relative to the start of the epoch, and its covariance.
  Eigen::Isometry3d T_epoch_left = Eigen::Isometry3d::Identity();
  vo::Matrix6d pose_covariance = vo::Matrix6d::Zero();
  /// Motion in `time_step` and its covariance; identity and zero if none was measured.
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();
  vo::Matrix6d motion_covariance = vo::Matrix6d::Zero();
  pipeline::StageTimes times;
  std::optional<vo::RigCalibrationError> rig;
  std::optional<vo::ReadoutEstimates> readouts;
  odometry_t message{};  ///< as cartvod publishes it; without sequence and publication
};

/// Result of a replay. After a loss of tracking the new epoch continues from the last known pose, and a pair
/// without an estimate repeats it, so that the path is continuous.
struct Replay {
  capture::SourceKind kind = capture::SourceKind::kitti;
  pipeline::FoundRig rig;
  std::vector<ReplayedPair> pairs;
  pipeline::PipelineCounts counts;
  std::optional<VideoTiming> timing;          ///< for two videos
  std::optional<capture::ClockStatus> clock;  ///< final state, for a recording with recomputed timestamps
  std::string self_check;                     ///< DriveSelfCheck::sentence; empty: no fault
  vo::ImageRegions still_regions;             ///< OdometryEstimate::still_regions at the end
  std::vector<std::string> problems;          ///< warnings and errors of the sources and the rig
};

/// Called after each pair. `expected`: number of pairs in the source, 0 if unknown.
using ReplayObserver = std::function<void(const pipeline::PairResult& result, std::size_t expected)>;

/// Processes all pairs of a source with the pipeline of cartvod. `absent_readout`: see PairProcessor; empty:
/// by the source's kind. `viewer`: see PairProcessor::setViewer; nullptr: none. Throws if the rig or the
/// settings are invalid.
Replay replayPairs(capture::StereoSource& source, const pipeline::FoundRig& rig,
                   const vo::OdometrySettings& odometry, const ReplayObserver& observer,
                   std::optional<pipeline::AbsentReadout> absent_readout = {},
                   pipeline::PairViewer* viewer = nullptr, const pipeline::AlertLimits& alert_limits = {});

/// Processes a source on disk. Throws if the source, the rig or the settings are invalid, or if no frames can
/// be paired.
Replay replaySource(const ReplaySettings& settings, const ReplayObserver& observer);

/// Processes two videos, `settings.source` and `settings.right_video`, or one that contains both cameras'
/// pictures.
Replay replayVideos(const ReplaySettings& settings, const VideoProgress& progress,
                    const ReplayObserver& observer);

/// Poses of the left camera, in its own axes, relative to the first pair's.
Trajectory leftCameraTrajectory(const Replay& replay);

/// Poses of the cart's body, relative to the first pair's. Omits pairs that are not later than the previous
/// one (the camera's clock was set back).
Trajectory bodyTrajectory(const Replay& replay);

/// The frame of bodyTrajectory(): the body only if the rig says how the cameras sit on it.
TrajectoryFrame bodyTrajectoryFrame(const Replay& replay);

}  // namespace cartvo
