// Replays a source through the pipeline of cartvod.

#include "tools/replay/replay.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "capture/dataset/video_file_source.hpp"
#include "capture/recording/recording_folder.hpp"
#include "daemon/diagnostics/self_check.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "daemon/service/configuration.hpp"
#include "tools/replay/light_by_seconds.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {
namespace {

/// Concatenates the epochs of the odometry, each of which starts at the identity.
class ContinuousPath {
 public:
  /// Returns the pose relative to the first pair.
  Eigen::Isometry3d add(const vo::OdometryEstimate& estimate) {
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

/// Transforms motions and covariances from the rectified left camera to the rig's left camera.
class RectificationInverse {
 public:
  explicit RectificationInverse(const Eigen::Isometry3d& T_left_rectified)
      : T_left_rectified_(T_left_rectified), adjoint_(vo::adjoint(T_left_rectified)) {}

  Eigen::Isometry3d transform(const Eigen::Isometry3d& motion) const {
    return T_left_rectified_ * motion * T_left_rectified_.inverse();
  }
  vo::Matrix6d transform(const vo::Matrix6d& covariance) const {
    return adjoint_ * covariance * adjoint_.transpose();
  }

 private:
  Eigen::Isometry3d T_left_rectified_;
  vo::Matrix6d adjoint_;
};

ReplayedPair toReplayedPair(const pipeline::PairResult& result, const RectificationInverse& left,
                            ContinuousPath& path) {
  const vo::OdometryEstimate& estimate = result.estimate;
  ReplayedPair pair;
  pair.exposure_ns = result.left.exposure_ns;
  pair.offset_ns = result.offset_ns();
  pair.valid = result.isValid();
  pair.reasons = estimate.reasons;
  pair.stereo_fault = estimate.stereo_fault;
  pair.reset_counter = estimate.reset_counter;
  pair.time_step = estimate.time_step;
  pair.counts = estimate.counts;
  pair.velocity = result.motion.velocity;
  pair.angular_velocity = result.motion.angular_velocity;
  pair.twist_covariance = result.motion.twist_covariance;
  pair.level = result.level;
  pair.T_first_left = left.transform(path.add(estimate));
  pair.T_epoch_left = left.transform(estimate.T_world_camera);
  pair.pose_covariance = left.transform(estimate.pose_covariance);
  pair.T_previous_current = left.transform(estimate.T_previous_current);
  pair.motion_covariance = left.transform(estimate.motion_covariance);
  pair.times = result.times;
  pair.rig = estimate.rig;
  pair.readouts = estimate.readouts;
  pair.message = daemon::odometryMessage(result);
  return pair;
}

calib::Rectifier buildRectifier(const calib::Rig& rig) {
  return {rig, rig.rectification, calib::buildTables(rig, rig.rectification)};
}

capture::ClockChoice toClockChoice(ReplayClock clock) {
  switch (clock) {
    case ReplayClock::ntp:
      return capture::ClockChoice::ntp;
    case ReplayClock::arrival:
      return capture::ClockChoice::arrival;
    case ReplayClock::visual:
      return capture::ClockChoice::visual;
    default:
      return capture::ClockChoice::automatic;
  }
}

/// The configuration that a recording contains; empty if there is none, or if it cannot be used, which is
/// added to `problems`.
std::optional<daemon::Configuration> recordedConfiguration(const std::filesystem::path& source,
                                                           std::vector<std::string>& problems) {
  if (!capture::isRecording(source)) return std::nullopt;
  const std::string text = capture::readRecordingInfo(source).configuration;
  try {
    if (!text.empty()) return daemon::parseConfiguration(text, source / "recording.json");
  } catch (const std::runtime_error& error) {
    problems.push_back(std::string("the recording's configuration cannot be used: ") + error.what());
  }
  return std::nullopt;
}

/// Settings to open the source with; those of a recording come from its configuration.
capture::SourceSettings sourceSettings(const ReplaySettings& settings,
                                       const std::optional<daemon::Configuration>& configuration) {
  capture::SourceSettings opened;
  opened.folder_offset_stddev_ns = 1e9 * settings.folder_offset_stddev;
  opened.frame_rate = settings.frame_rate;
  opened.side_by_side = settings.side_by_side;
  if (!capture::isRecording(settings.source)) return opened;
  if (configuration && settings.clock == ReplayClock::configured) opened.clock = configuration->clock;
  if (settings.clock >= ReplayClock::automatic) opened.clock = toClockChoice(settings.clock);
  return opened;
}

/// The readouts of the settings replace those of the rig.
void replaceReadouts(const ReplaySettings& settings, calib::Rig& rig) {
  if (!settings.readouts) return;
  rig.left.readout = settings.readouts->at(0);
  rig.right.readout = settings.readouts->at(1);
}

/// For replayPairs: readouts that the settings call unknown are unknown whatever the source.
std::optional<pipeline::AbsentReadout> absentReadout(const ReplaySettings& settings) {
  if (!settings.readouts) return std::nullopt;
  return pipeline::AbsentReadout::unknown;
}

/// Adds to the problems that the poses of the body are those of the left camera.
void noteMount(Replay& replay) {
  if (!calib::hasMount(replay.rig.rig)) replay.problems.emplace_back(calib::kNoMountText);
}

}  // namespace

Replay replayPairs(capture::StereoSource& source, const pipeline::FoundRig& rig,
                   const vo::OdometrySettings& odometry, const ReplayObserver& observer,
                   std::optional<pipeline::AbsentReadout> absent_readout, pipeline::PairViewer* viewer,
                   const pipeline::AlertLimits& alert_limits) {
  Replay replay;
  replay.kind = source.kind;
  replay.rig = rig;

  pipeline::PairProcessor processor(
      rig.rig, buildRectifier(rig.rig),
      {odometry, absent_readout.value_or(pipeline::absentReadoutOf(source.kind)), alert_limits});
  if (viewer != nullptr) processor.setViewer(*viewer);
  const RectificationInverse left(processor.T_left_rectified());
  pipeline::PipelineSettings settings{rig.rig.left.size, source.period_ns};
  if (source.clock) settings.set_visual_offset = [&](const auto& offset) { source.clock->setVisual(offset); };
  pipeline::Pipeline pipeline(*source.left, *source.right, processor, settings);
  ContinuousPath path;
  LightBySeconds light;
  daemon::SelfCheck self_check({rig.rig.left.readout, rig.rig.right.readout});
  DriveSelfCheck of_drive;
  std::optional<std::int64_t> first_ns;
  pipeline.replay({[&](const pipeline::PairResult& result) {
                     if (!first_ns) first_ns = result.estimate.exposure_ns;
                     replay.pairs.push_back(toReplayedPair(result, left, path));
                     light.add(result, replay.pairs.back().message);
                     self_check.setTexture(light.hasTexture());
                     self_check.update(result.estimate);
                     of_drive.add(self_check.message(),
                                  1e-9 * static_cast<double>(result.estimate.exposure_ns - *first_ns));
                     replay.still_regions = result.estimate.still_regions;
                     observer(result, source.pairs);
                   },
                   {}});

  replay.counts = pipeline.counts();
  replay.self_check = of_drive.sentence();
  if (source.clock) replay.clock = source.clock->status();
  replay.problems = source.warnings;
  for (std::string& problem : light.consumeProblems())
    replay.problems.push_back(std::move(problem));
  for (const capture::CameraSource* camera : {source.left.get(), source.right.get()}) {
    if (const std::string error = camera->health().last_error; !error.empty())
      replay.problems.push_back(error);
  }
  return replay;
}

Replay replaySource(const ReplaySettings& settings, const ReplayObserver& observer) {
  std::vector<std::string> problems;
  const std::optional<daemon::Configuration> configuration = recordedConfiguration(settings.source, problems);
  capture::StereoSource source =
      capture::openSource(settings.source, sourceSettings(settings, configuration));
  pipeline::FoundRig rig = pipeline::findRig(source, settings.source, settings.rig);
  // A rig file that is given takes the place of the recorded rig with all that the configuration changed.
  if (configuration && settings.rig.empty())
    rig.rig = daemon::withConfiguredReadouts(std::move(rig.rig), *configuration);
  replaceReadouts(settings, rig.rig);
  const pipeline::AlertLimits recorded_limits =
      configuration ? configuration->alert_limits : pipeline::AlertLimits{};
  Replay replay = replayPairs(source, rig, settings.odometry, observer, absentReadout(settings),
                              settings.viewer, settings.alert_limits.value_or(recorded_limits));
  replay.problems.insert(replay.problems.begin(), problems.begin(), problems.end());
  if (replay.pairs.empty()) {
    std::string message =
        settings.source.string() + ": no left and right image could be paired by their timestamps";
    for (const std::string& problem : replay.problems)
      message += "; " + problem;
    throw std::runtime_error(message);
  }
  noteMount(replay);
  return replay;
}

Replay replayVideos(const ReplaySettings& settings, const VideoProgress& progress,
                    const ReplayObserver& observer) {
  for (const std::filesystem::path& file : {settings.source, settings.right_video}) {
    if (!file.empty())
      capture::VideoFileSource(file, {.frame_rate = settings.frame_rate});  // refuses other files
  }
  pipeline::FoundRig rig = pipeline::findRig({}, settings.source, settings.rig);
  replaceReadouts(settings, rig.rig);
  const VideoPair videos = findVideos(settings.source, settings.right_video, settings.frame_rate, rig.rig);
  VideoTiming timing;
  if (videos.is_one_file) {
    timing.stddev = settings.folder_offset_stddev;
    timing.found_by = "one video with both pictures";
  } else if (settings.video_offset) {
    timing.offset = *settings.video_offset;
    timing.stddev = settings.folder_offset_stddev;
  } else {
    timing = findVideoTiming(videos, rig.rig, progress);
  }
  capture::StereoSource source = openVideos(videos, timing, {});
  Replay replay = replayPairs(source, rig, settings.odometry, observer, absentReadout(settings),
                              settings.viewer, settings.alert_limits.value_or(pipeline::AlertLimits{}));
  replay.timing = timing;
  if (replay.pairs.empty()) {
    throw std::runtime_error(videos.left.string() + " and " + videos.right.string() +
                             ": no left and right picture could be paired by their times; check --offset-ms");
  }
  noteMount(replay);
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

TrajectoryFrame bodyTrajectoryFrame(const Replay& replay) {
  return calib::hasMount(replay.rig.rig) ? TrajectoryFrame::body : TrajectoryFrame::unmounted_camera;
}

}  // namespace cartvo
