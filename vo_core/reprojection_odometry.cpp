// `estimator: reprojection`: the running track, a candidate track after a loss, and the states of
// IntegrityMonitor.
#include "vo_core/reprojection_odometry.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "common/threads/parallel_loop.hpp"
#include "vo_core/integrity/codec_error_model.hpp"
#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {
namespace {

/// Removes the codec shift of a key frame from a pose or motion that ends there.
Eigen::Isometry3d withoutShift(const Eigen::Isometry3d& measured, const PoseShift& shift) {
  return measured * motionFromVector(shift.value).inverse();
}

/// Builds the pyramid of `image` without a copy if it was written into the leased buffer, which then is used
/// up.
SharedPyramid buildPyramid(const cv::Mat& image, PyramidPool& pool, PyramidLease& lease) {
  return lease.holds(image) ? pool.build(std::exchange(lease, {})) : pool.build(image);
}

class ReprojectionOdometry final : public OdometryMethod {
 public:
  ReprojectionOdometry(const StereoCamera& camera, const OdometrySettings& settings,
                       const StereoShutters& shutters, const StereoMasks& masks)
      : camera_(camera),
        settings_(settings),
        timing_(camera, shutters),
        left_pyramids_(settings.tracking.levels, ImageMask(masks.left)),
        right_pyramids_(settings.tracking.levels, ImageMask(masks.right)),
        pitch_reinitialiser_(camera, settings.self_calibration, settings.tracking.levels) {}

  OdometryEstimate process(const StereoImages& images, IntegrityMonitor& integrity,
                           StageObserver& observer) override;
  void setTargetFeatureCount(int features) override;
  void acquireBuffers(StereoImages& images) override;
  void viewLandmarks(LandmarkViews& views) const override;

 private:
  PreparedPair prepare(const StereoImages& images, StageObserver& observer);
  OdometryEstimate reject(const PreparedPair& pair, OdometryReason reason) const;
  LearntByTracks latestLearnt() const;
  IntegrityAction observe(PreparedPair& pair, IntegrityMonitor& integrity, TrackedMotion& motion,
                          StageObserver& observer);
  void useCandidate();
  void endEpoch();
  void compensateCodecShift(const PreparedPair& pair, TrackedMotion& motion);
  OdometryEstimate startTrack(const PreparedPair& pair, OdometryReason reason, StageObserver& observer);
  OdometryEstimate wait(const PreparedPair& pair, const TrackedMotion& ambiguous, StageObserver& observer);
  OdometryEstimate handleLoss(const PreparedPair& pair, const TrackedMotion& failed, StageObserver& observer);
  OdometryEstimate toEstimate(const PreparedPair& pair, const TrackedMotion& motion) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  RowTiming timing_;
  PyramidPool left_pyramids_;
  PyramidPool right_pyramids_;
  PyramidLease left_lease_, right_lease_;   ///< buffers that the caller writes the next pair into
  PitchReinitialiser pitch_reinitialiser_;  ///< for first pairs of tracks: while lost, every pair is one
  std::optional<VisualTrack> track_;
  /// Started at the last pair that the running track has lost; replaces it if it can be tracked.
  std::optional<VisualTrack> candidate_track_;
  KeyFrames candidate_key_frames_;  ///< of the pair that the candidate track started at
  bool from_video_ = false;         ///< as PreparedPair's
  CodecErrorModel codec_errors_;
  std::optional<PoseShift> codec_shift_;  ///< of the track's last pair; removed from published poses
  int lost_pairs_ = 0;
  std::uint32_t epoch_ = 0;
  bool epoch_has_motion_ = false;
  std::int64_t next_index_ = 0;
};

void ReprojectionOdometry::setTargetFeatureCount(int features) {
  settings_.features = features;
  for (std::optional<VisualTrack>* track : {&track_, &candidate_track_})
    if (*track) (*track)->setTargetFeatureCount(features);
}

void ReprojectionOdometry::acquireBuffers(StereoImages& images) {
  const cv::Size size(camera_.width, camera_.height);
  if (left_lease_.image().empty()) left_lease_ = left_pyramids_.lease(size);
  if (right_lease_.image().empty()) right_lease_ = right_pyramids_.lease(size);
  images.left = left_lease_.image();
  images.right = right_lease_.image();
}

void ReprojectionOdometry::viewLandmarks(LandmarkViews& views) const {
  views.clear();
  if (track_) track_->viewLandmarks(next_index_ - 1, views);
}

PreparedPair ReprojectionOdometry::prepare(const StereoImages& images, StageObserver& observer) {
  const StageScope stage(observer, Stage::pyramid);
  PreparedPair pair;
  pair.index = next_index_++;
  pair.left_exposure_ns = images.left_exposure_ns;
  pair.right_exposure_ns = images.right_exposure_ns;
  pair.offset_stddev = images.offset_stddev;
  pair.key_frames = images.key_frames;
  from_video_ = from_video_ || images.key_frames.any();
  pair.from_video = from_video_;
  if (from_video_) pair.pose_noise_inflation = codec_errors_.poseNoiseInflation();
  doBoth([&] { pair.left = buildPyramid(images.left, left_pyramids_, left_lease_); },
         [&] { pair.right = buildPyramid(images.right, right_pyramids_, right_lease_); });
  return pair;
}

/// Estimate of a pair that is ignored: the last pose.
OdometryEstimate ReprojectionOdometry::reject(const PreparedPair& pair, OdometryReason reason) const {
  TrackedMotion motion;
  motion.reason = reason;
  return toEstimate(pair, motion);
}

OdometryEstimate ReprojectionOdometry::process(const StereoImages& images, IntegrityMonitor& integrity,
                                               StageObserver& observer) {
  PreparedPair pair = prepare(images, observer);
  const double offset = 1e-9 * static_cast<double>(pair.right_exposure_ns - pair.left_exposure_ns);
  if (std::abs(offset) > settings_.validity.maximum_offset)
    return reject(pair, OdometryReason::offset_too_large);
  if (!(pair.offset_stddev <= settings_.validity.maximum_offset_uncertainty))
    return reject(pair, OdometryReason::offset_uncertain);
  pair.evidence = integrity.evidence();
  const double step =
      track_ ? 1e-9 * static_cast<double>(pair.left_exposure_ns - track_->lastExposure()) : 0.0;
  pair.evidence.no_track = step <= 0.0;
  pair.evidence.late = step > settings_.validity.maximum_time_step;
  TrackedMotion motion;
  switch (observe(pair, integrity, motion, observer)) {
    case IntegrityAction::start_epoch:
      endEpoch();
      return startTrack(pair, motion.reason, observer);
    case IntegrityAction::reject:
      return reject(pair, motion.reason);
    case IntegrityAction::wait:
      return wait(pair, motion, observer);
    case IntegrityAction::relocalise:
      return handleLoss(pair, motion, observer);
    case IntegrityAction::measure:
    case IntegrityAction::publish:
      break;
  }
  candidate_track_.reset();
  lost_pairs_ = 0;
  epoch_has_motion_ = true;
  compensateCodecShift(pair, motion);
  return toEstimate(pair, motion);
}

/// Asks the table of the integrity, with more evidence each time, until it decides on the pair: before the
/// pair is tracked; by the running track; and, if that has lost the pair, by the candidate track, if there is
/// one. `motion` has the reason, or is the motion to be published, of the candidate if that has replaced the
/// running track.
IntegrityAction ReprojectionOdometry::observe(PreparedPair& pair, IntegrityMonitor& integrity,
                                              TrackedMotion& motion, StageObserver& observer) {
  IntegrityAction action = integrity.update(pair.evidence);
  motion.reason = track_ ? OdometryReason::time_step : OdometryReason::first_pair;
  if (action != IntegrityAction::measure) return action;
  pair.state = integrity.state();
  motion = track_->process(pair, observer);
  action = integrity.update(motion.evidence);
  if (action == IntegrityAction::relocalise) {
    pair.state = integrity.state();
    pair.evidence.by_candidate = true;
    TrackedMotion candidate_motion;
    candidate_motion.evidence = pair.evidence;
    candidate_motion.evidence.lost = true;
    if (candidate_track_) candidate_motion = candidate_track_->process(pair, observer);
    action = integrity.update(candidate_motion.evidence);
    if (action == IntegrityAction::publish) {
      useCandidate();
      motion = candidate_motion;
    }
  }
  if (action == IntegrityAction::reject || action == IntegrityAction::start_epoch)
    motion.reason = OdometryReason::repeated_picture;
  return action;
}

/// Replaces the running track by the candidate, in a new epoch.
void ReprojectionOdometry::useCandidate() {
  track_ = std::move(candidate_track_);
  candidate_track_.reset();
  lost_pairs_ = 0;
  endEpoch();
  codec_shift_ = codec_errors_.restart(candidate_key_frames_);
}

/// Removes the shifts of key frames from the start and end of a motion. The track itself keeps them.
void ReprojectionOdometry::compensateCodecShift(const PreparedPair& pair, TrackedMotion& motion) {
  if (motion.reason == OdometryReason::zero_velocity) {
    // The pose is kept, with the shift already removed from it.
    codec_errors_.restart(pair.key_frames);
    return;
  }
  const std::optional<PoseShift> before = codec_shift_;
  Eigen::Isometry3d& T = motion.T_previous_current;
  codec_shift_ = codec_errors_.update(pair.key_frames, {vectorFromMotion(T), motion.stddevByWindow(),
                                                        motion.time_step, motion.noise_is_uncalibrated});
  if (before) {
    const Matrix6d carried = adjoint(T.inverse());
    motion.by_codec_shift += carried * before->variance.asDiagonal() * carried.transpose();
    T = motionFromVector(before->value) * T;
  }
  if (!codec_shift_) return;
  motion.by_codec_shift += codec_shift_->variance.asDiagonal();
  T = withoutShift(T, *codec_shift_);
}

/// Estimates of the running track, with the rig calibration of the newest track, even if that track
/// fails: a search for the pitch is not repeated soon.
LearntByTracks ReprojectionOdometry::latestLearnt() const {
  if (!track_) {
    const auto readout_of = [this](const Shutter& shutter) {
      EstimateWithStddev readout{shutter.readout, shutter.readout_stddev};
      if (shutter.readout != 0.0 && readout.stddev == 0.0)
        readout.stddev = settings_.self_calibration.readout_stddev;
      return readout;
    };
    const auto& [left, right] = timing_.shutters();
    return {RigCalibration(settings_.self_calibration),
            {readout_of(left), readout_of(right)},
            StillRegions(camera_)};
  }
  LearntByTracks learnt = track_->learnt();
  if (candidate_track_) learnt.rig = candidate_track_->rig();
  return learnt;
}

/// Starts the running track anew at the pair.
OdometryEstimate ReprojectionOdometry::startTrack(const PreparedPair& pair, OdometryReason reason,
                                                  StageObserver& observer) {
  track_.emplace(camera_, settings_, timing_, pair, latestLearnt(), pitch_reinitialiser_, observer);
  codec_shift_ = codec_errors_.restart(pair.key_frames);
  candidate_track_.reset();
  lost_pairs_ = 0;
  TrackedMotion motion;
  motion.reason = reason;
  motion.counts.detected = track_->landmarkCount();
  motion.counts.stereo = track_->stereoCount();
  return toEstimate(pair, motion);
}

/// The next motion is in a new epoch. One without a motion goes on: no pose of it was used.
void ReprojectionOdometry::endEpoch() {
  if (epoch_has_motion_) ++epoch_;
  epoch_has_motion_ = false;
}

/// Keeps the track at a pair with an ambiguous motion. A track without a motion starts anew at the pair: in a
/// later one more of a vehicle would be found again than of the static world.
OdometryEstimate ReprojectionOdometry::wait(const PreparedPair& pair, const TrackedMotion& ambiguous,
                                            StageObserver& observer) {
  if (!track_->hasMotion()) return startTrack(pair, ambiguous.reason, observer);
  candidate_track_.reset();
  TrackedMotion motion = ambiguous;
  motion.counts.detected = track_->landmarkCount();
  motion.counts.stereo = track_->stereoCount();
  return toEstimate(pair, motion);
}

/// Starts a candidate track at a pair that the running track has lost. After tracking.search_again pairs it
/// replaces the running track in a new epoch.
OdometryEstimate ReprojectionOdometry::handleLoss(const PreparedPair& pair, const TrackedMotion& failed,
                                                  StageObserver& observer) {
  TrackedMotion motion = failed;
  candidate_track_.emplace(camera_, settings_, timing_, pair, latestLearnt(), pitch_reinitialiser_, observer);
  candidate_key_frames_ = pair.key_frames;
  motion.counts.detected = candidate_track_->landmarkCount();
  motion.counts.stereo = candidate_track_->stereoCount();
  if (++lost_pairs_ > settings_.tracking.search_again) {
    useCandidate();
  }
  if (motion.counts.detected < settings_.validity.minimum_features)
    motion.reason = OdometryReason::too_few_features;
  return toEstimate(pair, motion);
}

OdometryEstimate ReprojectionOdometry::toEstimate(const PreparedPair& pair,
                                                  const TrackedMotion& motion) const {
  OdometryEstimate estimate;
  estimate.exposure_ns = pair.left_exposure_ns;
  estimate.valid = motion.valid();
  estimate.reasons = motion.reason;
  estimate.reset_counter = epoch_;
  estimate.counts = motion.counts;
  if (track_) {
    estimate.T_world_camera = track_->pose();
    estimate.pose_covariance = track_->poseCovariance();
    if (codec_shift_) {
      estimate.T_world_camera = withoutShift(estimate.T_world_camera, *codec_shift_);
      estimate.pose_covariance += codec_shift_->variance.asDiagonal();
    }
    estimate.rig = track_->rigCalibrationError();
    estimate.readouts = track_->readouts();
    estimate.still_regions = track_->stillRegions().regions();
  }
  estimate.part_stands = motion.part_stands && !estimate.valid;
  if (!estimate.valid) return estimate;
  estimate.time_step = motion.time_step;
  estimate.T_previous_current = motion.T_previous_current;
  estimate.motion_covariance = motion.covariance();
  estimate.twist = motion.twist;
  return estimate;
}

}  // namespace

std::unique_ptr<OdometryMethod> makeReprojectionOdometry(const StereoCamera& camera,
                                                         const OdometrySettings& settings,
                                                         const StereoShutters& shutters,
                                                         const StereoMasks& masks) {
  return std::make_unique<ReprojectionOdometry>(camera, settings, shutters, masks);
}

}  // namespace cartvo::vo
