#include "tools/replay/replay.hpp"

#include <stdexcept>
#include <utility>

#include "calib/rectification_tables.hpp"
#include "calib/rectifier.hpp"

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

ReplayedPair kept(const PairResult& result, const Eigen::Isometry3d& T_first_left) {
  ReplayedPair pair;
  pair.exposure_ns = result.left.exposure_ns;
  pair.offset_ns = result.offset_ns();
  pair.valid = result.estimate.valid;
  pair.reasons = result.estimate.reasons;
  pair.reset_counter = result.estimate.reset_counter;
  pair.time_step = result.estimate.time_step;
  pair.counts = result.estimate.counts;
  pair.velocity = result.motion.velocity;
  pair.angular_velocity = result.motion.angular_velocity;
  pair.T_first_left = T_first_left;
  pair.times = result.times;
  return pair;
}

Rectifier rectifierOf(const Rig& rig) {
  const RectificationSettings settings;
  return {rig, settings, buildTables(rig, settings)};
}

}  // namespace

Replay replaySource(const ReplaySettings& settings, const ReplayObserver& observer) {
  StereoSource source = openSource(settings.source);
  Replay replay;
  replay.kind = source.kind;
  replay.rig = findRig(source, settings.source, settings.rig);

  const Rig& rig = replay.rig.rig;
  PairProcessor processor(rig, rectifierOf(rig), settings.odometry);
  const Eigen::Isometry3d T_left_rectified = processor.T_left_rectified();
  Pipeline pipeline(*source.left, *source.right, processor, {rig.left.size, source.period_ns});
  UnbrokenPath path;
  pipeline.replay({[&](const PairResult& result) {
                     const Eigen::Isometry3d pose = path.add(result.estimate);
                     replay.pairs.push_back(
                         kept(result, T_left_rectified * pose * T_left_rectified.inverse()));
                     observer(result, source.pairs);
                   },
                   {}});

  if (replay.pairs.empty()) {
    throw std::runtime_error(settings.source.string() + ": holds no pair of images that belong together");
  }
  replay.counts = pipeline.counts();
  for (const CameraSource* camera : {source.left.get(), source.right.get()}) {
    if (const std::string error = camera->health().last_error; !error.empty())
      replay.problems.push_back(error);
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
