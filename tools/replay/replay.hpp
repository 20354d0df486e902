#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/stereo_source.hpp"
#include "daemon/pipeline.hpp"
#include "tools/replay/source_rig.hpp"
#include "tools/replay/video_pair.hpp"
#include "tools/trajectory/trajectory.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// Where a recording's instants come from.
enum class ReplayClock : std::uint8_t {
  configured,  ///< the clock model as live, by the recording's configuration; as recorded, if it has none
  recorded,    ///< as they were stamped live
  automatic,   ///< the clock model by that choice, see ClockChoice
  ntp,
  arrival,
  visual,
};

struct ReplaySettings {
  std::filesystem::path source;
  std::filesystem::path right_video;   ///< empty, or the right camera's; then `source` is the left camera's
  std::optional<double> video_offset;  ///< s, added to the right video's times; nothing: by the pictures
  std::filesystem::path rig;           ///< empty: found beside the source
  OdometrySettings odometry;
  double folder_offset_deviation = 0.0;  ///< s, of the pairs' offsets in a folder of images
  ReplayClock clock = ReplayClock::configured;
};

/// What is kept of one pair.
struct ReplayedPair {
  std::int64_t exposure_ns = 0;  ///< of the left image
  std::int64_t offset_ns = 0;
  bool valid = false;
  OdometryReasons reasons;
  std::uint32_t reset_counter = 0;
  double time_step = 0.0;  ///< s since the pair that the motion is measured from; 0 if not valid
  FeatureCounts counts;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< as BodyMotion's; NaN if not valid
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< as BodyMotion's; NaN if not valid
  Matrix6d twist_covariance = Matrix6d::Zero();                ///< as BodyMotion's; NaN if not valid

  // Velocities and their covariances are as published, with the rig's scale_deviation in them; what follows
  // is the odometry's own, without it.
  // Of the rig's left camera, in its own axes: what OdometryEstimate says of the rectified one, whose
  // rotation is undone. Covariances are perturbations on the right, in the axes of the current camera.
  /// Pose since the first pair, across epochs.
  Eigen::Isometry3d T_first_left = Eigen::Isometry3d::Identity();
  /// Pose since the epoch began, and its covariance.
  Eigen::Isometry3d T_epoch_left = Eigen::Isometry3d::Identity();
  Matrix6d pose_covariance = Matrix6d::Zero();
  /// Motion in `time_step`; identity if not valid. And its covariance; zero if not valid.
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();
  Matrix6d motion_covariance = Matrix6d::Zero();
  StageTimes times;
  std::optional<RigCheck> rig;
};

/// A source as the pipeline saw it. Where the pose began anew after a loss, the new epoch goes on from the
/// last pose known, and a pair without an estimate repeats it, so that there is one unbroken path.
struct Replay {
  SourceKind kind = SourceKind::kitti;
  FoundRig rig;
  std::vector<ReplayedPair> pairs;
  PipelineCounts counts;
  std::optional<VideoTiming> timing;  ///< of two videos
  std::optional<ClockStatus> clock;   ///< of a recording that was stamped anew, at its end
  std::string self_check;             ///< what to mend between the cameras, as at the end; empty: all is well
  std::vector<std::string> problems;  ///< what the sources said of themselves (a recording cut short)
};

/// Is told of each pair as it was processed, and how many are expected (0: unknown).
using ReplayObserver = std::function<void(const PairResult& result, std::size_t expected)>;

/// Runs the daemon's pipeline over a source, each pair in turn, none dropped for time. Throws what the rig or
/// the settings are refused for.
Replay replayPairs(StereoSource& source, const FoundRig& rig, const OdometrySettings& odometry,
                   const ReplayObserver& observer);

/// The same over a source on disk. Throws what the source, the rig or the settings are refused for, also if
/// no pair of its images belongs together.
Replay replaySource(const ReplaySettings& settings, const ReplayObserver& observer);

/// The same of two videos: `settings.source` and `settings.right_video`.
Replay replayVideos(const ReplaySettings& settings, const VideoProgress& progress,
                    const ReplayObserver& observer);

/// Poses of the left camera, in its own axes, relative to the first pair's.
Trajectory leftCameraTrajectory(const Replay& replay);

/// Poses of the cart's body, relative to the first pair's. A pair that is not later than the one before (the
/// camera's clock was set back) has none.
Trajectory bodyTrajectory(const Replay& replay);

}  // namespace cartvo
