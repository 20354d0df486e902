// Tracks of pairs: one that lasts, and after a loss another that may take its place.
#include "vo_core/reprojection_odometry.hpp"

#include <cmath>
#include <optional>

#include "vo_core/parallel_loop.hpp"
#include "vo_core/plausible_motion.hpp"
#include "vo_core/video_errors.hpp"
#include "vo_core/visual_track.hpp"

namespace cartvo {
namespace {

/// A pose or motion that ends where the pair is, of one that ends where its key frames show it.
Eigen::Isometry3d withoutShift(const Eigen::Isometry3d& shown, const PoseShift& shift) {
  return shown * motionFromVector(shift.value).inverse();
}

double secondsSince(const VisualTrack& track, std::int64_t exposure_ns) {
  return 1e-9 * static_cast<double>(exposure_ns - track.lastExposure());
}

class ReprojectionOdometry final : public OdometryMethod {
 public:
  ReprojectionOdometry(const StereoCamera& camera, const OdometrySettings& settings)
      : camera_(camera),
        settings_(settings),
        left_pyramids_(settings.tracking.levels),
        pitch_suspicion_(camera) {}

  OdometryEstimate process(const StereoImages& images, const PictureRepeats& repeats,
                           StageObserver& observer) override;
  void aimAt(int features) override;
  void placeNext(StereoImages& images) override;

 private:
  PreparedPair prepare(const StereoImages& images, StageObserver& observer);
  bool offsetInRange(const PreparedPair& pair) const;
  OdometryEstimate refuse(const PreparedPair& pair, OdometryReason reason) const;
  bool timeStepInRange(const VisualTrack& track, std::int64_t exposure_ns) const;
  bool stopsTooSoon(const PreparedPair& pair) const;
  bool atRest(const TrackedMotion& motion) const;
  RigMonitor knownOfRig() const;
  enum class Succession { none, hangs, takes_over };  ///< hangs: at a picture that cannot stand still
  Succession trySuccessor(const PreparedPair& pair, TrackedMotion& motion, StageObserver& observer);
  void passOver(const PreparedPair& pair, const TrackedMotion& motion);
  void takeOutShift(const PreparedPair& pair, TrackedMotion& motion);
  OdometryEstimate begin(const PreparedPair& pair, OdometryReason reason, StageObserver& observer);
  OdometryEstimate beginAnew(const PreparedPair& pair, OdometryReason reason, StageObserver& observer);
  OdometryEstimate lose(const PreparedPair& pair, const TrackedMotion& failed, StageObserver& observer);
  OdometryEstimate estimateOf(const PreparedPair& pair, const TrackedMotion& motion) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  PyramidPool left_pyramids_;
  PyramidPool right_pyramids_{kLandmarkLevels};
  PitchSuspicion pitch_suspicion_;  ///< at the first pairs of tracks: while lost, each pair is one
  std::optional<VisualTrack> track_;
  /// Begun at a pair that the track could not explain: if that goes on, the next epoch.
  std::optional<VisualTrack> successor_;
  KeyFrames successor_begins_;  ///< at a pair with these
  bool coded_ = false;          ///< as PreparedPair's
  VideoErrors video_errors_;
  std::optional<PoseShift> shift_;  ///< of the track's last pair, which is taken out of what is told of it
  int lost_pairs_ = 0;
  /// Since when a picture stands still though the cart cannot have stopped when it began to, if one does.
  std::optional<std::int64_t> hangs_since_ns_;
  bool right_hangs_ = false;  ///< its picture has stayed the same though the cart moved
  std::uint32_t epoch_ = 0;
  std::int64_t next_index_ = 0;
};

void ReprojectionOdometry::aimAt(int features) {
  settings_.features = features;
  for (std::optional<VisualTrack>* track : {&track_, &successor_})
    if (*track) (*track)->aimAt(features);
}

void ReprojectionOdometry::placeNext(StereoImages& images) {
  const cv::Size size(camera_.width, camera_.height);
  images.left = left_pyramids_.place(size);
  images.right = right_pyramids_.place(size);
}

PreparedPair ReprojectionOdometry::prepare(const StereoImages& images, StageObserver& observer) {
  const StageScope stage(observer, Stage::pyramid);
  PreparedPair pair;
  pair.index = next_index_++;
  pair.left_exposure_ns = images.left_exposure_ns;
  pair.right_exposure_ns = images.right_exposure_ns;
  pair.offset_deviation = images.offset_deviation;
  pair.key_frames = images.key_frames;
  coded_ = coded_ || images.key_frames.any();
  pair.coded = coded_;
  if (coded_) pair.excess = video_errors_.excess();
  doBoth([&] { pair.left = left_pyramids_.build(images.left); },
         [&] { pair.right = right_pyramids_.build(images.right); });
  return pair;
}

bool ReprojectionOdometry::timeStepInRange(const VisualTrack& track, std::int64_t exposure_ns) const {
  const double step = secondsSince(track, exposure_ns);
  return step > 0.0 && step <= settings_.validity.maximum_time_step;
}

bool ReprojectionOdometry::offsetInRange(const PreparedPair& pair) const {
  const double offset = 1e-9 * static_cast<double>(pair.right_exposure_ns - pair.left_exposure_ns);
  return std::abs(offset) <= settings_.validity.maximum_offset;
}

/// As if the pair had not come.
OdometryEstimate ReprojectionOdometry::refuse(const PreparedPair& pair, OdometryReason reason) const {
  TrackedMotion motion;
  motion.reasons = reason;
  return estimateOf(pair, motion);
}

OdometryEstimate ReprojectionOdometry::process(const StereoImages& images, const PictureRepeats& repeats,
                                               StageObserver& observer) {
  PreparedPair pair = prepare(images, observer);
  pair.repeats = repeats;
  if (!offsetInRange(pair)) return refuse(pair, OdometryReason::time_step);
  if (!(pair.offset_deviation <= settings_.validity.maximum_offset_uncertainty))
    return refuse(pair, OdometryReason::offset_uncertain);
  right_hangs_ = right_hangs_ && pair.repeats.right;
  if (right_hangs_) return refuse(pair, OdometryReason::repeated_picture);
  if (!track_) return begin(pair, OdometryReason::first_pair, observer);
  const bool in_time = timeStepInRange(*track_, pair.left_exposure_ns);
  // A track whose left picture hangs is what tells that it goes on, however late.
  if (!in_time && !(track_->leftHangs() && secondsSince(*track_, pair.left_exposure_ns) > 0.0))
    return beginAnew(pair, OdometryReason::time_step, observer);
  const bool of_hanging = hangs_since_ns_ && track_->lastExposure() >= *hangs_since_ns_;
  TrackedMotion motion = track_->process(pair, observer);
  if (motion.reasons == OdometryReason::repeated_picture) {
    right_hangs_ = !track_->leftHangs();
    return refuse(pair, motion.reasons);
  }
  if (!in_time) return beginAnew(pair, OdometryReason::repeated_picture, observer);
  if (motion.valid() && hangs_since_ns_) {
    if (atRest(motion)) {
      passOver(pair, motion);
      return refuse(pair, OdometryReason::repeated_picture);
    }
    hangs_since_ns_.reset();
    // Begun at a picture that hung, whose instant is not what the stamps say: it measures no motion from
    // there.
    if (of_hanging) return beginAnew(pair, OdometryReason::repeated_picture, observer);
  }
  // Of a pair later still, more of what moves beside the cart would be found again than of the world.
  if (motion.rivalled) return begin(pair, motion.reasons, observer);
  if (!motion.valid()) {
    const Succession succession = trySuccessor(pair, motion, observer);
    if (succession == Succession::hangs) return refuse(pair, OdometryReason::repeated_picture);
    if (succession == Succession::none) return lose(pair, motion, observer);
  }
  successor_.reset();
  lost_pairs_ = 0;
  takeOutShift(pair, motion);
  return estimateOf(pair, motion);
}

/// What becomes of the successor at a pair that the track does not explain; if it takes the track's place,
/// `motion` is its own.
ReprojectionOdometry::Succession ReprojectionOdometry::trySuccessor(const PreparedPair& pair,
                                                                    TrackedMotion& motion,
                                                                    StageObserver& observer) {
  if (!successor_) return Succession::none;
  const TrackedMotion anew = successor_->process(pair, observer);
  if (!anew.valid()) return Succession::none;
  if (atRest(anew) && (hangs_since_ns_ || stopsTooSoon(pair))) {
    if (!hangs_since_ns_) hangs_since_ns_ = pair.left_exposure_ns;
    return Succession::hangs;
  }
  if (hangs_since_ns_) {  // it began at a picture that hung
    hangs_since_ns_.reset();
    return Succession::none;
  }
  track_ = std::move(successor_);
  ++epoch_;
  shift_ = video_errors_.begin(successor_begins_);
  motion = anew;
  return Succession::takes_over;
}

/// The track has gone on by a motion that tells nothing of the video.
void ReprojectionOdometry::passOver(const PreparedPair& pair, const TrackedMotion& motion) {
  const std::optional<PoseShift> shift = video_errors_.begin(pair.key_frames);
  // During a stand the pose is held, with what was taken out of it.
  if (motion.reasons != OdometryReason::zero_velocity) shift_ = shift;
}

/// The track goes by what the pictures show, shifted where key frames are; a motion that is told begins and
/// ends without their shifts.
void ReprojectionOdometry::takeOutShift(const PreparedPair& pair, TrackedMotion& motion) {
  if (motion.reasons == OdometryReason::zero_velocity) return passOver(pair, motion);
  const std::optional<PoseShift> before = shift_;
  Eigen::Isometry3d& T = motion.T_previous_current;
  shift_ = video_errors_.next(pair.key_frames, {vectorFromMotion(T), motion.deviation_by_landmarks,
                                                motion.time_step, motion.guessed});
  if (before) {
    const Matrix6d carried = adjoint(T.inverse());
    motion.motion_covariance += carried * before->variance.asDiagonal() * carried.transpose();
    T = motionFromVector(before->value) * T;
  }
  if (!shift_) return;
  motion.motion_covariance += shift_->variance.asDiagonal();
  T = withoutShift(T, *shift_);
}

/// Whether the cart, as fast as the track knew it, is still on its way at that pair. A camera that hangs is
/// told by its pictures' bytes (RepeatedPictures), unless an encoder goes on refining the same picture.
bool ReprojectionOdometry::stopsTooSoon(const PreparedPair& pair) const {
  return track_->velocity() && !canStop(*track_->velocity(), secondsSince(*track_, pair.left_exposure_ns));
}

bool ReprojectionOdometry::atRest(const TrackedMotion& motion) const {
  const Vector6d moved = vectorFromMotion(motion.T_previous_current);
  return moved.head<3>().norm() <= 2.0 * settings_.standstill.translation &&
         moved.tail<3>().norm() <= 2.0 * settings_.standstill.rotation;
}

/// By the newest track, even if it came to nothing: what it found out would not be looked for again so soon.
RigMonitor ReprojectionOdometry::knownOfRig() const {
  if (successor_) return successor_->rig();
  return track_ ? track_->rig() : RigMonitor();
}

OdometryEstimate ReprojectionOdometry::begin(const PreparedPair& pair, OdometryReason reason,
                                             StageObserver& observer) {
  track_.emplace(camera_, settings_, pair, knownOfRig(), pitch_suspicion_, observer);
  shift_ = video_errors_.begin(pair.key_frames);
  successor_.reset();
  lost_pairs_ = 0;
  TrackedMotion motion;
  motion.reasons = reason;
  motion.counts.detected = track_->landmarkCount();
  motion.counts.stereo = track_->stereoCount();
  return estimateOf(pair, motion);
}

/// In another epoch.
OdometryEstimate ReprojectionOdometry::beginAnew(const PreparedPair& pair, OdometryReason reason,
                                                 StageObserver& observer) {
  ++epoch_;
  return begin(pair, reason, observer);
}

/// The pair explains nothing. A successor begins at it; the track itself is tried for some pairs more.
OdometryEstimate ReprojectionOdometry::lose(const PreparedPair& pair, const TrackedMotion& failed,
                                            StageObserver& observer) {
  TrackedMotion motion = failed;
  successor_.emplace(camera_, settings_, pair, knownOfRig(), pitch_suspicion_, observer);
  successor_begins_ = pair.key_frames;
  motion.counts.detected = successor_->landmarkCount();
  motion.counts.stereo = successor_->stereoCount();
  if (++lost_pairs_ > settings_.tracking.search_again) {
    track_ = std::move(successor_);
    successor_.reset();
    lost_pairs_ = 0;
    ++epoch_;
    shift_ = video_errors_.begin(successor_begins_);
  }
  if (motion.counts.detected < settings_.validity.minimum_features)
    motion.reasons = OdometryReason::too_few_features;
  return estimateOf(pair, motion);
}

OdometryEstimate ReprojectionOdometry::estimateOf(const PreparedPair& pair,
                                                  const TrackedMotion& motion) const {
  OdometryEstimate estimate;
  estimate.exposure_ns = pair.left_exposure_ns;
  estimate.valid = motion.valid();
  estimate.reasons = motion.reasons;
  estimate.reset_counter = epoch_;
  estimate.counts = motion.counts;
  if (track_) {
    estimate.T_world_camera = track_->pose();
    estimate.pose_covariance = track_->poseCovariance();
    if (shift_) {
      estimate.T_world_camera = withoutShift(estimate.T_world_camera, *shift_);
      estimate.pose_covariance += shift_->variance.asDiagonal();
    }
    estimate.rig = track_->rigCheck();
  }
  if (!estimate.valid) return estimate;
  estimate.time_step = motion.time_step;
  estimate.T_previous_current = motion.T_previous_current;
  estimate.motion_covariance = motion.motion_covariance;
  estimate.motion_offset_error = motion.motion_offset_error;
  return estimate;
}

}  // namespace

std::unique_ptr<OdometryMethod> makeReprojectionOdometry(const StereoCamera& camera,
                                                         const OdometrySettings& settings) {
  return std::make_unique<ReprojectionOdometry>(camera, settings);
}

}  // namespace cartvo
