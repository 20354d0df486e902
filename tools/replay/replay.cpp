#include "tools/replay/replay.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "calib/rectification_tables.hpp"
#include "calib/rectifier.hpp"
#include "capture/recording_folder.hpp"
#include "daemon/configuration.hpp"
#include "daemon/self_check.hpp"
#include "daemon/visual_clock.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {
namespace {

/// Lays the epochs of the odometry, each of which starts at the identity, one behind the other.
class UnbrokenPath {
 public:
  Eigen::Isometry3d add(const OdometryEstimate& estimate) {
    if (estimate.reset_counter != epoch_) {
      epoch_ = estimate.reset_counter;
      T_first_epoch_ = T_first_current_;
    }
    if (estimate.valid) T_first_current_ = T_first_epoch_ * estimate.T_world_camera;
    return T_first_current_;
  }

 private:
  std::uint32_t epoch_ = 0;
  Eigen::Isometry3d T_first_epoch_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_first_current_ = Eigen::Isometry3d::Identity();
};

/// Tells of the rig's left camera what the odometry tells of the rectified one.
class LeftCameraView {
 public:
  explicit LeftCameraView(const Eigen::Isometry3d& T_left_rectified)
      : T_left_rectified_(T_left_rectified), adjoint_(adjoint(T_left_rectified)) {}

  Eigen::Isometry3d of(const Eigen::Isometry3d& motion) const {
    return T_left_rectified_ * motion * T_left_rectified_.inverse();
  }
  Matrix6d of(const Matrix6d& covariance) const { return adjoint_ * covariance * adjoint_.transpose(); }

 private:
  Eigen::Isometry3d T_left_rectified_;
  Matrix6d adjoint_;
};

ReplayedPair kept(const PairResult& result, const LeftCameraView& left, UnbrokenPath& path) {
  const OdometryEstimate& estimate = result.estimate;
  ReplayedPair pair;
  pair.exposure_ns = result.left.exposure_ns;
  pair.offset_ns = result.offset_ns();
  pair.valid = estimate.valid;
  pair.reasons = estimate.reasons;
  pair.reset_counter = estimate.reset_counter;
  pair.time_step = estimate.time_step;
  pair.counts = estimate.counts;
  pair.velocity = result.motion.velocity;
  pair.angular_velocity = result.motion.angular_velocity;
  pair.twist_covariance = result.motion.twist_covariance;
  pair.T_first_left = left.of(path.add(estimate));
  pair.T_epoch_left = left.of(estimate.T_world_camera);
  pair.pose_covariance = left.of(estimate.pose_covariance);
  pair.T_previous_current = left.of(estimate.T_previous_current);
  pair.motion_covariance = left.of(estimate.motion_covariance);
  pair.times = result.times;
  pair.rig = estimate.rig;
  return pair;
}

Rectifier rectifierOf(const Rig& rig) {
  return {rig, rig.rectification, buildTables(rig, rig.rectification)};
}

ClockChoice choiceOf(ReplayClock clock) {
  switch (clock) {
    case ReplayClock::ntp:
      return ClockChoice::ntp;
    case ReplayClock::arrival:
      return ClockChoice::arrival;
    case ReplayClock::visual:
      return ClockChoice::visual;
    default:
      return ClockChoice::automatic;
  }
}

/// How the source is opened: a recording as its configuration says.
SourceSettings sourceSettings(const ReplaySettings& settings, std::vector<std::string>& problems) {
  SourceSettings opened;
  opened.folder_offset_deviation_ns = 1e9 * settings.folder_offset_deviation;
  if (!isRecording(settings.source)) return opened;
  const std::string text = readRecordingInfo(settings.source).configuration;
  std::optional<Configuration> configuration;
  try {
    if (!text.empty()) configuration = parseConfiguration(text, settings.source / "recording.json");
  } catch (const std::runtime_error& error) {
    problems.push_back(std::string("the recording's configuration is of no use: ") + error.what());
  }
  if (configuration) opened.recording_period_ns = std::llround(1e9 / configuration->frame_rate);
  if (configuration && settings.clock == ReplayClock::configured) opened.clock = configuration->clock;
  if (settings.clock >= ReplayClock::automatic) opened.clock = choiceOf(settings.clock);
  return opened;
}

}  // namespace

Replay replayPairs(StereoSource& source, const FoundRig& rig, const OdometrySettings& odometry,
                   const ReplayObserver& observer) {
  Replay replay;
  replay.kind = source.kind;
  replay.rig = rig;

  PairProcessor processor(rig.rig, rectifierOf(rig.rig), odometry);
  const LeftCameraView left(processor.T_left_rectified());
  Pipeline pipeline(*source.left, *source.right, processor, {rig.rig.left.size, source.period_ns});
  UnbrokenPath path;
  VisualClock visual_clock;
  SelfCheck self_check;
  pipeline.replay({[&](const PairResult& result) {
                     replay.pairs.push_back(kept(result, left, path));
                     self_check.note(result.estimate);
                     if (source.clock) {
                       source.clock->setVisual(visual_clock.add(result.estimate.rig,
                                                                static_cast<double>(result.applied_ns()),
                                                                result.estimate.time_step));
                     }
                     observer(result, source.pairs);
                   },
                   {}});

  replay.counts = pipeline.counts();
  replay.self_check = self_check.sentence();
  if (source.clock) replay.clock = source.clock->status();
  for (const CameraSource* camera : {source.left.get(), source.right.get()}) {
    if (const std::string error = camera->health().last_error; !error.empty())
      replay.problems.push_back(error);
  }
  return replay;
}

Replay replaySource(const ReplaySettings& settings, const ReplayObserver& observer) {
  std::vector<std::string> problems;
  StereoSource source = openSource(settings.source, sourceSettings(settings, problems));
  const FoundRig rig = findRig(source, settings.source, settings.rig);
  Replay replay = replayPairs(source, rig, settings.odometry, observer);
  replay.problems.insert(replay.problems.begin(), problems.begin(), problems.end());
  if (replay.pairs.empty()) {
    throw std::runtime_error(settings.source.string() + ": holds no pair of images that belong together");
  }
  return replay;
}

Replay replayVideos(const ReplaySettings& settings, const VideoProgress& progress,
                    const ReplayObserver& observer) {
  const VideoPair videos{settings.source, settings.right_video};
  const FoundRig rig = findRig({}, settings.source, settings.rig);
  VideoTiming timing;
  if (settings.video_offset) {
    timing.offset = *settings.video_offset;
    timing.deviation = settings.folder_offset_deviation;
  } else {
    timing = findVideoTiming(videos, rig.rig, progress);
  }
  StereoSource source = openVideos(videos, timing, {});
  Replay replay = replayPairs(source, rig, settings.odometry, observer);
  replay.timing = timing;
  if (replay.pairs.empty()) {
    throw std::runtime_error(videos.left.string() + " and " + videos.right.string() +
                             ": no two pictures belong together by their times; see to --offset-ms");
  }
  return replay;
}

Trajectory leftCameraTrajectory(const Replay& replay) {
  Trajectory trajectory;
  trajectory.reserve(replay.pairs.size());
  for (const ReplayedPair& pair : replay.pairs)
    trajectory.push_back({pair.exposure_ns, pair.T_first_left});
  return trajectory;
}

Trajectory bodyTrajectory(const Replay& replay) {
  const Eigen::Isometry3d& T_body_left = replay.rig.rig.T_body_camera;
  Trajectory trajectory;
  for (const ReplayedPair& pair : replay.pairs) {
    if (!trajectory.empty() && pair.exposure_ns <= trajectory.back().time_ns) continue;
    trajectory.push_back({pair.exposure_ns, T_body_left * pair.T_first_left * T_body_left.inverse()});
  }
  return trajectory;
}

}  // namespace cartvo
