// Processing of a pair by a track: landmarks are tracked, the pose is searched, landmarks are replenished and
// matched in stereo. The other steps: visual_track_ambiguity.cpp, _adjustment.cpp, _standstill.cpp.
#include "vo_core/track/visual_track.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vo_core/estimation/pose_points.hpp"
#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/plausible_motion.hpp"
#include "vo_core/geometry/triangulation.hpp"
#include "vo_core/self_calibration/newest_pair.hpp"

namespace cartvo::vo {
namespace {

double seconds(std::int64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

WindowFrame frameOf(const PreparedPair& pair) {
  WindowFrame frame;
  frame.index = pair.index;
  frame.exposure_ns = pair.left_exposure_ns;
  frame.offset = seconds(pair.right_exposure_ns - pair.left_exposure_ns);
  frame.left = pair.left;
  return frame;
}

/// Inverse depth (1/m) in the camera at the exposure of a point seen in the direction `bearing` at another
/// instant, with its inverse depth there.
double inverseDepthAt(const Eigen::Isometry3d& T_exposure_instant, const Eigen::Vector3d& bearing,
                      double inverse_depth) {
  const double depth =
      T_exposure_instant.linear().row(2).dot(bearing) + inverse_depth * T_exposure_instant.translation().z();
  return inverse_depth / std::max(depth, kNearestRay);
}

/// Initial depth of a landmark whose only observation is in stereo. `T_right_left`: at the instants of its
/// rows; `T_exposure_instant`: of the left camera.
void initialiseDepth(Landmark& landmark, const StereoCamera& camera, const Eigen::Isometry3d& T_right_left,
                     const Eigen::Isometry3d& T_exposure_instant, const Eigen::Vector2d& right_pixel,
                     const WindowNoise& noise) {
  constexpr double kStretch = 0.006;  // px of noise per px of disparity: near patches deform more
  const auto found = triangulate(camera, T_right_left, landmark.anchor().left, right_pixel);
  if (!found) return;
  landmark.inverse_depth =
      inverseDepthAt(T_exposure_instant, bearingOf(camera, landmark.anchor().left), found->inverse_depth);
  const double disparity_noise = std::hypot(noise.right, (1.0 - noise.common) * noise.left) +
                                 kStretch * std::abs(landmark.anchor().stereo_offset.x());
  const double stddev = disparity_noise / (camera.focal_length * found->sensitivity);
  landmark.information = 1.0 / (stddev * stddev);
}

}  // namespace

VisualTrack::VisualTrack(const StereoCamera& camera, const OdometrySettings& settings,
                         const RowTiming& timing, const PreparedPair& first, const LearntByTracks& learnt,
                         PitchReinitialiser& reinitialiser, StageObserver& observer)
    : camera_(camera),
      settings_(settings),
      timing_(timing),
      tracker_(camera, settings),
      random_(settings.seed),
      pitch_reinitialiser_(camera, settings.self_calibration, settings.tracking.levels),
      standstill_(settings.standstill),
      frozen_camera_(settings.standstill),
      estimates_{learnt.rig,
                 learnt.readouts,
                 learnt.still_regions,
                 PredictionErrors(settings.self_calibration.correlated_pairs),
                 {},
                 {},
                 {},
                 {}},
      stereo_share_(learnt.stereo_share),
      last_exposure_ns_(first.left_exposure_ns),
      unambiguous_ns_(first.left_exposure_ns),
      draft_{{}, {}, estimates_} {
  timing_.use(learnt.readouts);
  // All buffers reserve the capacity of these lists.
  landmarks_.reserve(settings.features);
  pose_problem_.moved.reserve(settings.features);
  draft_.landmarks.reserve(settings.features);
  right_rows_.reserve(settings.features);
  {
    const StageScope stage(observer, Stage::detect);
    tracker_.replenish(landmarks_, *first.left, first.index);
  }
  const StageScope stage(observer, Stage::disparity);
  window_.push_back(frameOf(first));
  matchStereo(first, window_, reinitialiser, landmarks_);
  // The speed is unknown: with a time offset the depths are uncertain.
  const double relative_stddev =
      settings.unknown_velocity * std::abs(window_.back().offset) / camera.baseline;
  for (Landmark& landmark : landmarks_) {
    if (!landmark.hasDepth() || relative_stddev == 0.0) continue;
    const double stddev = relative_stddev * std::max(landmark.inverse_depth, 0.0);
    landmark.information = 1.0 / (1.0 / landmark.information + stddev * stddev);
  }
}

std::optional<ReadoutEstimates> VisualTrack::readouts() const {
  if (!timing_.mayRoll()) return std::nullopt;
  return estimates_.readouts;
}

void VisualTrack::viewLandmarks(std::int64_t pair, LandmarkViews& views) const {
  for (const Landmark& landmark : landmarks_)
    if (landmark.last().frame == pair) views.push_back(viewOf(landmark, pair - 1));
}

int VisualTrack::stereoCount() const {
  return countStereo(landmarks_);
}

bool VisualTrack::estimatesRig() const {
  return settings_.rig_refinement == RigRefinement::correct;
}

std::optional<RigCalibrationError> VisualTrack::rigCalibrationError() const {
  if (!estimatesRig()) return std::nullopt;
  return estimates_.rig.error();
}

double VisualTrack::secondsSinceLast(const PreparedPair& pair) const {
  return seconds(pair.left_exposure_ns - last_exposure_ns_);
}

/// Pose at constant velocity.
Eigen::Isometry3d VisualTrack::expectedPose(const PreparedPair& pair) const {
  const Eigen::Isometry3d& last = window_.back().T_world_camera;
  return velocity_ ? last * motionFromVector(secondsSinceLast(pair) * *velocity_) : last;
}

TrackedMotion VisualTrack::process(const PreparedPair& pair, StageObserver& observer) {
  TrackedMotion motion = track(pair, observer);
  motion.evidence.tracked = motion.valid();
  motion.evidence.zero_velocity = motion.reason == OdometryReason::zero_velocity;
  motion.evidence.lost = !motion.valid();
  draft_.window.clear();  // releases the images
  return motion;
}

TrackedMotion VisualTrack::track(const PreparedPair& pair, StageObserver& observer) {
  TrackedMotion motion;
  motion.time_step = secondsSinceLast(pair);
  motion.evidence = pair.evidence;
  Draft& draft = draft_;
  draft.window = window_;
  draft.window.push_back(frameOf(pair));
  predictMotion(pair, draft);
  trackLandmarks(pair, draft, motion, observer);
  {
    const StageScope stage(observer, Stage::motion);
    if (!searchPose(pair, draft, motion)) return motion;
  }
  const bool within_standstill = observeLeft(draft, motion.evidence);
  checkRightCamera(pair, draft, motion.evidence, observer);
  if (isRejected(pair, motion)) return motion;
  const bool still_stands = standing_ && within_standstill;
  if (standing_) {
    motion.counts.detected = static_cast<int>(landmarks_.size());
    if (still_stands) applyZeroVelocity(pair, motion);
    const bool enough_landmarks = motion.counts.matched >= kMajority * landmarks_when_stopped_;
    if (still_stands && enough_landmarks) return motion;
  }
  // The pair is added if its motion is valid. In a standstill, too many landmarks of its start are lost.
  replenishLandmarks(pair, draft, motion, observer);
  const StageScope stage(observer, Stage::weights);
  if (still_stands) {
    if (!lacksStereo(motion)) refreshStandstill(pair, draft, motion);
    return motion;
  }
  adjust(pair, draft, motion);
  // The first motion after a standstill starts at the held pose, not at the true one.
  if (standing_) motion.by_standstill = standstill_.covariance();
  if (!motion.valid()) return motion;
  standing_ = standstill_.update(motion.T_world_camera, pair.left_exposure_ns);
  if (standing_) {
    landmarks_when_stopped_ = motion.counts.matched;
    velocity_ = Vector6d::Zero();
    log_odds_ = std::max(log_odds_, track_start::kEstablished);
  }
  return motion;
}

void VisualTrack::trackLandmarks(const PreparedPair& pair, Draft& draft, TrackedMotion& motion,
                                 StageObserver& observer) {
  const StageScope stage(observer, Stage::optical_flow);
  // The oldest pair of a full window leaves it when this pair is accepted.
  const bool full = static_cast<int>(window_.size()) == settings_.window.pairs;
  std::optional<Eigen::Isometry3d> expected;
  if (velocity_) expected = expectedPose(pair);
  TrackedImage image{window_, *pair.left, pair.index, window_[full ? 1 : 0].index, expected};
  const TrackingOutcome outcome = tracker_.track(landmarks_, draft.landmarks, image);
  draft.start = outcome.T_world_camera.value_or(expectedPose(pair));
  correctNewestRows(draft, draft.start);
  draft.prediction_failed = outcome.prediction_failed;
  if (draft.prediction_failed) searchAgainAtFoundPose(pair, image, draft);
  if (pair.from_video) inflateCodecNoise(draft.landmarks, settings_.tracking);
  motion.counts.tracked = static_cast<int>(draft.landmarks.size());
}

/// Searches the landmarks once more at the pose of those that the wide search has found: near that pose, more
/// of them are found, and nearer ones.
void VisualTrack::searchAgainAtFoundPose(const PreparedPair& pair, TrackedImage& image, Draft& draft) {
  buildPoseProblem(pair, draft);
  if (static_cast<int>(chosen_.size()) < settings_.validity.minimum_matches) return;
  const auto found = findPose();
  if (!found || !hasEnoughInliers(*found, settings_.validity)) return;
  image.T_world_camera = found->T_world_camera;
  image.pose_is_found = true;
  tracker_.track(landmarks_, draft.landmarks, image);
  draft.start = found->T_world_camera;
  correctNewestRows(draft, draft.start);
}

void VisualTrack::replenishLandmarks(const PreparedPair& pair, Draft& draft, TrackedMotion& motion,
                                     StageObserver& observer) {
  {
    const StageScope stage(observer, Stage::detect);
    tracker_.replenish(draft.landmarks, *pair.left, pair.index);
    motion.counts.detected = static_cast<int>(draft.landmarks.size());
  }
  const StageScope stage(observer, Stage::disparity);
  if (!standing_ || !motion.evidence.stands) predictByWindow(pair, draft);
  matchStereo(pair, draft.window, pitch_reinitialiser_, draft.landmarks);
  motion.counts.stereo = countStereo(draft.landmarks);
}

void VisualTrack::accept(const PreparedPair& pair, Draft& draft) {
  if (static_cast<int>(draft.window.size()) > settings_.window.pairs)
    draft.window.erase(draft.window.begin());
  window_.swap(draft.window);
  landmarks_.swap(draft.landmarks);
  last_exposure_ns_ = pair.left_exposure_ns;
}

/// Predicts the motion about the pair's exposure.
void VisualTrack::predictMotion(const PreparedPair& pair, Draft& draft) {
  MotionPredictions& predictions = draft.predictions;
  predictions.time_step = secondsSinceLast(pair);
  predictions.extrapolated = componentsOf(window_.back().motion);
  predictions.extrapolated.head<6>() += predictions.time_step * predictions.extrapolated.segment<6>(6);
  predictions.extrapolated.tail<3>().setZero();
  predictions.mean.setZero();
  for (const WindowFrame& frame : window_)
    predictions.mean.head<6>() += frame.motion.velocity / static_cast<double>(window_.size());
  const PredictedMotion predicted = estimates_.prediction_errors.combine(predictions);
  predicted_variances_ = predicted.variances;
  draft.window.back().motion = motionOf(predicted.motion);
}

/// Computes the row shifts of the newest pair's observations for the left camera at `T_world_camera`.
void VisualTrack::correctNewestRows(Draft& draft, const Eigen::Isometry3d& T_world_camera) {
  if (!timing_.isRolling()) return;
  draft.window.back().T_world_camera = T_world_camera;
  correctRows(camera_, timing_, draft.window, draft.window.size() - 1,
              settings_.tracking.predicted_inverse_depth, draft.landmarks);
}

/// Adds the uncertainty of the predicted motion to the noise of the points of the pose search.
void VisualTrack::addRowNoise(const Draft& draft) {
  const MotionComponents& variances = predicted_variances_;
  const double translation = variances.head<3>().mean(), rotation = variances.segment<3>(3).mean();
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    PosePoint& point = pose_problem_.points[i];
    const double instant = timing_.left(draft.landmarks[chosen_[i]].last().left);
    point.row_noise = camera_.focal_length * std::abs(instant) *
                      std::sqrt(rotation + point.inverse_depth * point.inverse_depth * translation);
  }
}

/// Finds the initial pose, which most landmarks agree on. Returns false and sets the reason if there is none.
bool VisualTrack::searchPose(const PreparedPair& pair, Draft& draft, TrackedMotion& motion) {
  buildPoseProblem(pair, draft);
  motion.counts.matched = static_cast<int>(chosen_.size());
  if (motion.counts.matched < settings_.validity.minimum_matches) {
    motion.reason = OdometryReason::too_few_matches;
    return false;
  }
  const auto found = findPose();
  if (!found || !hasEnoughInliers(*found, settings_.validity)) {
    motion.reason = OdometryReason::too_few_inliers;
    return false;
  }
  motion.counts.inliers = found->inliers;
  const bool by_chance = found->inliers < settings_.pose_search.minimum_share * countWithDepth(landmarks_);
  motion.evidence.ambiguous = !by_chance && isAmbiguous(pair, *found, motion);
  const bool is_fixed = isFixedToImage(pose_problem_, *found);
  // A world that moves past a part of the cart: the start of the track is no longer established.
  if (is_fixed && static_cast<double>(pose_problem_.moved.size()) > kMajority * found->inliers)
    log_odds_ = 0.0;
  if (motion.evidence.ambiguous || by_chance || is_fixed) {
    motion.part_stands = countStillInliers(pose_problem_) > kMajority * found->inliers;
    motion.reason = OdometryReason::too_few_inliers;
    return false;
  }
  draft.window.back().T_world_camera = found->T_world_camera;
  draft.pose_covariance = pose_finder_.covarianceOf(pose_problem_, *found);
  correctNewestRows(draft, found->T_world_camera);
  for (std::size_t i = 0; i < chosen_.size(); ++i)
    draft.landmarks[chosen_[i]].observations.back().outlier = pose_problem_.points[i].outlier;
  return true;
}

/// Searches the pose within the motion gate. If it explains less than half of the landmarks, searches beyond
/// the gate, too: an unambiguous pose is measured, whatever the cart can do.
std::optional<FoundPose> VisualTrack::findPose() {
  const auto search = [&] { return pose_finder_.find(pose_problem_, settings_.pose_search, random_); };
  auto within_gate = search();
  if (!pose_problem_.admissible_change) return within_gate;
  if (within_gate && within_gate->inlier_ratio >= kMajority) return within_gate;
  const std::optional<Vector6d> gate = std::exchange(pose_problem_.admissible_change, std::nullopt);
  if (auto beyond = search(); beyond && beyond->inlier_ratio >= kUnambiguousShare) return beyond;
  pose_problem_.admissible_change = gate;
  return search();  // sets the points' flags again
}

/// Motion gate from the maximum acceleration.
Vector6d VisualTrack::admissibleChange(const PreparedPair& pair) const {
  const double square = std::pow(secondsSinceLast(pair), 2);
  return Vector6d::Constant(settings_.pose_search.maximum_acceleration * square);
}

void VisualTrack::buildPoseProblem(const PreparedPair& pair, const Draft& draft) {
  PoseProblem& problem = pose_problem_;
  problem.camera = camera_;
  for (int level = 0; level < kLandmarkLevels; ++level)
    problem.noise[level] = track_window_.noise()[level].left;
  problem.anchors.clear();
  for (const WindowFrame& frame : window_)
    problem.anchors.push_back(frame.T_world_camera);
  problem.start = draft.start;
  problem.expected = expectedPose(pair);
  problem.admissible_change.reset();
  if (velocity_) problem.admissible_change = admissibleChange(pair);
  toPosePoints(draft.landmarks, window_, camera_, problem.points, chosen_);
  problem.moved.clear();
  for (const Landmark& landmark : draft.landmarks)
    if (!landmark.hasDepth() && landmark.lastFlow() > still_regions::kMovedFlow)
      problem.moved.push_back(landmark.last().left);
  if (timing_.isRolling()) addRowNoise(draft);
}

void VisualTrack::matchStereo(const PreparedPair& pair, const std::vector<WindowFrame>& window,
                              PitchReinitialiser& reinitialiser, std::vector<Landmark>& landmarks) {
  const Eigen::Isometry3d T_right_left = rightFromLeft(window.back(), camera_.baseline);
  const NewestPair newest{tracker_, camera_, timing_, *pair.left, *pair.right, window};
  matchStereoRotated(newest, T_right_left, estimates_.rig, landmarks);
  if (estimatesRig() && reinitialiser.tryReinitialise(newest, T_right_left, landmarks, estimates_.rig)) {
    discardLastStereo(landmarks);  // matches at the wrong pitch are by chance
    matchStereoRotated(newest, T_right_left, estimates_.rig, landmarks);
  }

  const RigCorrection rig = estimates_.rig.correction();
  const RowTransform right_from_left(camera_, timing_, window.back(), T_right_left);
  for (Landmark& landmark : landmarks) {
    const Observation& anchor = landmark.anchor();
    if (landmark.hasDepth() || landmark.observations.size() > 1 || !anchor.stereo) continue;
    if (estimates_.still_regions.contains(anchor.left)) continue;
    initialiseDepth(landmark, camera_, right_from_left.at(anchor.left),
                    right_from_left.exposureFromLeft(anchor.left),
                    correctedRight(camera_, rig, anchor.right()), track_window_.noise()[landmark.level]);
  }
}

}  // namespace cartvo::vo
