// From one pair to the next: follow, search, match, adjust.
#include "vo_core/visual_track.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "vo_core/bundle_noise.hpp"
#include "vo_core/newest_pair.hpp"
#include "vo_core/plausible_motion.hpp"
#include "vo_core/triangulation.hpp"
#include "vo_core/window_problems.hpp"
#include "vo_core/window_uncertainty.hpp"

namespace cartvo {
namespace {

constexpr double kUnknownSpeed = 3.0;  // m/s that the cart may have at the first pair
constexpr int kLeastStanding = 3;      // poses; where fewer can stand, none but the newest moves
constexpr double kNoticeable = 0.02;   // px that a change of the rig's correction moves points
constexpr double kStillTranslation = 3e-4, kStillRotation = 5e-5;  // m and rad, deviation of a stand's motion
constexpr double kEnoughToHold = 0.5;  // of the landmarks that the stand began with
// Of what the first motion of a track explains: on rendered worlds without traffic any other explained 0.26
// at most, and where a vehicle was taken for the world, that explained 0.65 at least.
constexpr double kClearlyLess = 0.5;
constexpr double kClearlyMoving = 5.0;                             // standard deviations
constexpr double kSlackTranslation = 0.02, kSlackRotation = 0.01;  // m and rad, that any motion may change by

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

/// How far two corrections are apart, in units of normalised coordinates.
double differenceOf(const RigCorrection& a, const RigCorrection& b) {
  return std::abs(a.yaw - b.yaw) + std::abs(a.bend - b.bend) + std::abs(a.pitch - b.pitch) +
         std::abs(a.roll - b.roll);
}

void dropDistrusted(std::vector<Landmark>& landmarks, double least_trust) {
  std::erase_if(landmarks, [&](const Landmark& landmark) { return landmark.trust < least_trust; });
}

/// How many times as large as residuals tell the variance of the `n`-th motion of a track is, while a window
/// of `most` pairs fills with its first ones: their noise is a guess that has hardly been put right yet, and
/// in the dark, where few landmarks of a first pair are found again, many of those agree by chance. At dusk
/// the first motion's squared error was 11 times what it said, that of the second to the sixth 2.4 times
/// (docs/accuracy.md). Poses, whose covariance is more than the sum of their motions', have no need of it.
double doubtOfFirst(int n, int most) {
  constexpr double kFirst = 9.0;
  return n < most ? 1.0 + kFirst / n : 1.0;
}

/// Poses that have been published and are not settled yet keep to where they are, by a share of what they are
/// known by.
void holdPublished(const std::vector<WindowFrame>& window, double share, BundleProblem& problem) {
  problem.held.clear();
  for (std::size_t i = 0; i + 1 < window.size(); ++i) {
    Matrix6d& held = problem.held.emplace_back(Matrix6d::Zero());
    if (share > 0.0 && static_cast<int>(i) >= problem.fixed)
      held = share * window[i].local_covariance.ldlt().solve(Matrix6d::Identity());
  }
}

/// First depth of a landmark whose only sighting is in stereo.
void giveDepth(Landmark& landmark, const StereoCamera& camera, const Eigen::Isometry3d& T_right_left,
               const Eigen::Vector2d& right_pixel, const BundleNoises& noises) {
  const auto found = triangulate(camera, T_right_left, landmark.host().left, right_pixel);
  if (!found) return;
  landmark.inverse_depth = found->inverse_depth;
  const BundleNoise& noise = noises[landmark.level];
  const double deviation = (noise.disparity + noise.stretch * std::abs(landmark.host().parallax.x())) /
                           (camera.focal_length * found->lever);
  landmark.information = 1.0 / (deviation * deviation);
}

}  // namespace

VisualTrack::VisualTrack(const StereoCamera& camera, const OdometrySettings& settings,
                         const PreparedPair& first, const RigMonitor& rig, PitchSuspicion& suspicion,
                         StageObserver& observer)
    : camera_(camera),
      settings_(settings),
      tracker_(camera, settings),
      random_(settings.seed),
      rig_(rig),
      pitch_suspicion_(camera),
      standstill_(settings.standstill),
      stand_witness_(camera, settings),
      last_exposure_ns_(first.left_exposure_ns) {
  // What is worked with has room for as many landmarks as these lists.
  landmarks_.reserve(settings.features);
  draft_.landmarks.reserve(settings.features);
  {
    const StageScope stage(observer, Stage::detect);
    tracker_.renew(landmarks_, *first.left, first.index);
  }
  const StageScope stage(observer, Stage::disparity);
  window_.push_back(frameOf(first));
  matchStereo(first, window_, suspicion, landmarks_);
  // How fast the cart is, is not known: with two instants, its depths are vague.
  const double vague = kUnknownSpeed * std::abs(window_.back().offset) / camera.baseline;
  for (Landmark& landmark : landmarks_) {
    if (!landmark.hasDepth() || vague == 0.0) continue;
    const double deviation = vague * std::max(landmark.inverse_depth, 0.0);
    landmark.information = 1.0 / (1.0 / landmark.information + deviation * deviation);
  }
}

int VisualTrack::stereoCount() const {
  return countStereo(landmarks_);
}

Matrix6d VisualTrack::poseCovariance() const {
  return poseCovarianceOf(window_.back());
}

bool VisualTrack::corrects() const {
  return settings_.rig_refinement == RigRefinement::correct;
}

std::optional<RigCheck> VisualTrack::rigCheck() const {
  if (!corrects()) return std::nullopt;
  return rig_.check();
}

double VisualTrack::secondsSinceLast(const PreparedPair& pair) const {
  return seconds(pair.left_exposure_ns - last_exposure_ns_);
}

/// Where the camera should be now if it went on as before; or, of a left picture that hangs, as it shows.
Eigen::Isometry3d VisualTrack::expectedPose(const PreparedPair& pair) const {
  const Eigen::Isometry3d& last = window_.back().T_world_camera;
  return velocity_ && !leftHangs() ? last * motionFromVector(secondsSinceLast(pair) * *velocity_) : last;
}

TrackedMotion VisualTrack::process(const PreparedPair& pair, StageObserver& observer) {
  TrackedMotion motion = explain(pair, observer);
  draft_.window.clear();  // it would keep the images
  return motion;
}

/// And takes it in, if it is to be.
TrackedMotion VisualTrack::explain(const PreparedPair& pair, StageObserver& observer) {
  TrackedMotion motion;
  motion.time_step = secondsSinceLast(pair);
  Draft& draft = draft_;
  draft.landmarks = landmarks_;
  draft.window = window_;
  draft.window.push_back(frameOf(pair));
  {
    const StageScope stage(observer, Stage::optical_flow);
    // The oldest pair leaves the window once this one has come.
    const bool full = static_cast<int>(window_.size()) == settings_.bundle.frames;
    std::optional<Eigen::Isometry3d> expected;
    if (velocity_) expected = expectedPose(pair);
    tracker_.follow(draft.landmarks, window_, *pair.left, pair.index, window_[full ? 1 : 0].index, expected);
    if (pair.coded) doubtLastPositions(draft.landmarks);
    motion.counts.tracked = static_cast<int>(draft.landmarks.size());
  }
  {
    const StageScope stage(observer, Stage::motion);
    if (!searchPose(pair, draft, motion)) return motion;
  }
  const bool stays =
      !standstill_.beyond(window_.back().T_world_camera.inverse() * draft.window.back().T_world_camera);
  askRight(pair, stays, draft, observer);
  if (leftHangs() || (!stays && pair.repeats.right)) {
    motion.reasons = OdometryReason::repeated_picture;
    return motion;
  }
  const bool held = standing_ && stays;
  const bool stood = standing_;
  if (standing_) {
    motion.counts.detected = static_cast<int>(landmarks_.size());
    if (held) holdStill(pair, motion);
    const bool enough = motion.counts.matched >= kEnoughToHold * landmarks_when_stopped_;
    if (held && enough) return motion;
    // The pair is taken in: the cart moves, or too much of what it saw when it stopped has gone.
    standing_ = held;
  }
  {
    const StageScope stage(observer, Stage::detect);
    tracker_.renew(draft.landmarks, *pair.left, pair.index);
    motion.counts.detected = static_cast<int>(draft.landmarks.size());
  }
  {
    const StageScope stage(observer, Stage::disparity);
    matchStereo(pair, draft.window, pitch_suspicion_, draft.landmarks);
    motion.counts.stereo = countStereo(draft.landmarks);
  }
  const StageScope stage(observer, Stage::weights);
  if (held)
    renewStand(pair, draft, motion);
  else
    adjust(pair, draft, motion);
  // The first motion after a stand begins where the cart was held, not quite where it was.
  if (stood && !held) motion.motion_covariance += standstill_.stray();
  if (!held && motion.valid() && standstill_.stands(motion.T_world_camera, pair.left_exposure_ns)) {
    standing_ = true;
    landmarks_when_stopped_ = motion.counts.matched;
    velocity_ = Vector6d::Zero();
  }
  return motion;
}

/// Takes a pair of a stand in, at the pose that is held, with the landmarks it brings.
void VisualTrack::renewStand(const PreparedPair& pair, Draft& draft, const TrackedMotion& motion) {
  WindowFrame& current = draft.window.back();
  current.T_world_camera = motion.T_world_camera;
  current.uncertainty = window_.back().uncertainty;
  current.by_late_right = window_.back().by_late_right;
  current.offset_error = window_.back().offset_error;
  current.local_covariance = motion.motion_covariance;
  accept(pair, draft);
  stand_witness_.forget();
  landmarks_when_stopped_ = static_cast<int>(std::count_if(
      landmarks_.begin(), landmarks_.end(), [](const Landmark& landmark) { return landmark.hasDepth(); }));
}

void VisualTrack::accept(const PreparedPair& pair, Draft& draft) {
  if (static_cast<int>(draft.window.size()) > settings_.bundle.frames)
    draft.window.erase(draft.window.begin());
  window_.swap(draft.window);
  landmarks_.swap(draft.landmarks);
  last_exposure_ns_ = pair.left_exposure_ns;
}

/// The start of the estimate: the pose most landmarks agree on. False, with the reason, if there is none.
bool VisualTrack::searchPose(const PreparedPair& pair, Draft& draft, TrackedMotion& motion) {
  statePoseProblem(pair, draft);
  motion.counts.matched = static_cast<int>(chosen_.size());
  if (motion.counts.matched < settings_.validity.minimum_matches) {
    motion.reasons = OdometryReason::too_few_matches;
    return false;
  }
  const auto found = pose_finder_.find(pose_problem_, settings_.pose_search, random_);
  if (!found || !enoughAgree(*found, settings_.validity)) {
    motion.reasons = OdometryReason::too_few_inliers;
    return false;
  }
  motion.counts.inliers = found->inliers;
  motion.rivalled = !velocity_ && rivalled(*found);
  if (motion.rivalled) {
    motion.reasons = OdometryReason::too_few_inliers;
    return false;
  }
  draft.window.back().T_world_camera = found->T_world_camera;
  for (std::size_t i = 0; i < chosen_.size(); ++i)
    if (!pose_problem_.points[i].inlier) draft.landmarks[chosen_[i]].trust *= 0.5;
  dropDistrusted(draft.landmarks, settings_.history.minimum_weight);
  return true;
}

/// Whether the points that the found pose leaves agree on another one too well. As long as nobody knows how
/// fast the cart is, a bus beside it is as good a world as the world.
bool VisualTrack::rivalled(const FoundPose& found) const {
  PoseProblem rest = pose_problem_;
  std::erase_if(rest.points, [](const PosePoint& point) { return point.inlier; });
  SubsetRandom random(settings_.seed);  // its own: what is asked here changes no motion
  const auto rival = PoseFinder().find(rest, settings_.pose_search, random);
  return rival && rival->inliers >= settings_.validity.minimum_inliers &&
         rival->weight > kClearlyLess * found.weight;
}

/// By how much the pose may differ from what is expected, as carts are.
Vector6d VisualTrack::admissibleChange(const PreparedPair& pair) const {
  const double square = std::pow(secondsSinceLast(pair), 2);
  const PoseSearchSettings& limits = settings_.pose_search;
  Vector6d change;
  change << Eigen::Vector3d::Constant(limits.maximum_acceleration * square + kSlackTranslation),
      Eigen::Vector3d::Constant(limits.maximum_turn * square + kSlackRotation);
  return change;
}

void VisualTrack::statePoseProblem(const PreparedPair& pair, const Draft& draft) {
  PoseProblem& problem = pose_problem_;
  problem.camera = camera_;
  problem.noise = noise_;
  problem.hosts.clear();
  for (const WindowFrame& frame : window_)
    problem.hosts.push_back(frame.T_world_camera);
  problem.start = expectedPose(pair);
  problem.admissible_change.reset();
  if (velocity_) problem.admissible_change = admissibleChange(pair);
  takePoints(draft.landmarks, window_, camera_, problem.points, chosen_);
}

/// A parked cart is measured against the pairs from before its stand, and none is taken into the window:
/// nothing adds up, however long it stands and whatever drives past. The motion is nil.
void VisualTrack::holdStill(const PreparedPair& pair, TrackedMotion& motion) {
  const WindowFrame& stand = window_.back();
  motion.reasons = OdometryReason::zero_velocity;
  motion.T_world_camera = stand.T_world_camera;
  motion.motion_covariance.setZero();
  motion.motion_covariance.diagonal() << Eigen::Vector3d::Constant(kStillTranslation * kStillTranslation),
      Eigen::Vector3d::Constant(kStillRotation * kStillRotation);
  last_exposure_ns_ = pair.left_exposure_ns;
}

/// Whether the cart has clearly been moving up to now.
bool VisualTrack::expectsToMove(const PreparedPair& pair) const {
  if (!velocity_) return false;
  const Vector6d motion = secondsSinceLast(pair) * *velocity_;
  const auto clearly = [&](const auto& part, const auto& deviation) {
    return part.norm() > kClearlyMoving * deviation.norm();
  };
  return standstill_.beyond(motionFromVector(motion)) &&
         (clearly(motion.head<3>(), last_deviation_.head<3>()) ||
          clearly(motion.tail<3>(), last_deviation_.tail<3>()));
}

/// Of a left picture that shows no motion the right one is asked whether that can be: where the cart stood or
/// was moving, and where it is the one before.
void VisualTrack::askRight(const PreparedPair& pair, bool stays, Draft& draft, StageObserver& observer) {
  const bool asked = standing_ || stand_witness_.listens() || pair.repeats.left || expectsToMove(pair);
  if (!stays || !asked) return stand_witness_.forget();
  const StageScope stage(observer, Stage::disparity);
  const double offset = std::abs(seconds(pair.right_exposure_ns - pair.left_exposure_ns));
  const Vector6d slack = 2.0 * offset * velocity_.value_or(Vector6d::Zero());
  stand_witness_.hear({{tracker_, *pair.left, *pair.right, draft.window},
                       pair.left_exposure_ns,
                       pair.repeats.left,
                       rig_,
                       noise_,
                       admissibleChange(pair),
                       slack.head<3>().norm(),
                       slack.tail<3>().norm()},
                      {window_, landmarks_}, draft.landmarks, {pose_problem_, chosen_, pose_finder_});
  forgetLastStereo(draft.landmarks);
}

void VisualTrack::matchStereo(const PreparedPair& pair, const std::vector<WindowFrame>& window,
                              PitchSuspicion& suspicion, std::vector<Landmark>& landmarks) {
  const Eigen::Isometry3d T_right_left = newestRightFromLeft(timedPoses(window), camera_.baseline);
  const auto match_turned = [&](std::vector<Landmark>& wanted, const RigMonitor& rig) {
    matchTurned({tracker_, *pair.left, *pair.right, window}, T_right_left, rig, wanted);
  };
  const MatchBy match = std::cref(match_turned);  // which it refers to: what it would hold, it would allocate
  match(landmarks, rig_);
  if (corrects() && suspicion.take({landmarks, window, match}, rig_)) {
    forgetLastStereo(landmarks);  // the matches there are, are by chance
    match(landmarks, rig_);
  }
  // The rows of a camera that has driven on tell of the motion, and are not to agree with what was foretold.
  if (pair.coded && keepsRows(T_right_left)) forgetOffRows(landmarks, rows_);

  const RigCorrection rig = rig_.correction();
  for (Landmark& landmark : landmarks) {
    const Sighting& host = landmark.host();
    if (landmark.hasDepth() || landmark.sightings.size() > 1 || !host.stereo) continue;
    giveDepth(landmark, camera_, T_right_left, correctedRight(camera_, rig, host.left - host.parallax),
              noise_);
  }
}

void VisualTrack::stateBundle(const Draft& draft, const RigCorrection& rig) {
  BundleProblem& problem = bundle_;
  problem.camera = camera_;
  problem.noise = noise_;
  problem.poses = timedPoses(draft.window);
  const int poses = static_cast<int>(draft.window.size());
  problem.fixed = std::max(poses - settings_.bundle.free_frames, std::min(poses - 1, kLeastStanding));
  problem.standing_share = settings_.bundle.standing_share;
  holdPublished(draft.window, settings_.bundle.hold, problem);
  takeLandmarks(draft.landmarks, draft.window, camera_, rig, problem.landmarks, chosen_);
}

/// The least squares over the window; if its result is believed, the draft becomes what is known.
void VisualTrack::adjust(const PreparedPair& pair, Draft& draft, TrackedMotion& motion) {
  RigCorrection rig = rig_.correction();
  stateBundle(draft, rig);
  BundleResult result = adjuster_.adjust(bundle_, settings_.bundle);
  // Older poses stand, so that a wrong scale lasts as long as the window: a rig that turns out to be off is
  // corrected before the first pose is settled, not after.
  RigMonitor learned = rigAfter(result, draft, rig);
  if (const RigCorrection better = learned.correction();
      kNoticeable < camera_.focal_length * differenceOf(better, rig)) {
    rig = better;
    stateBundle(draft, rig);
    result = adjuster_.adjust(bundle_, settings_.bundle);
    learned = rigAfter(result, draft, rig);
  }
  if (!result.converged) {
    motion.reasons = OdometryReason::degenerate_geometry;
    return;
  }
  for (std::size_t i = 0; i < draft.window.size(); ++i)
    draft.window[i].T_world_camera = bundle_.poses[i].T_world_camera;
  weigh(draft);
  const MotionUncertainty uncertainty = takeUncertainties(
      bundle_, result, {overlap_.of(bundle_), pair.excess, pair.offset_deviation}, draft.window);
  motion.T_world_camera = draft.window.back().T_world_camera;
  motion.T_previous_current =
      draft.window[draft.window.size() - 2].T_world_camera.inverse() * motion.T_world_camera;
  // A motion that is doubted for what its landmarks do not tell is vague, not degenerate.
  motion.reasons = judge(motion, uncertainty.by_landmarks + uncertainty.byOffset());
  if (!motion.valid()) return;
  const double doubt = doubtOfFirst(static_cast<int>(draft.window.size()) - 1, settings_.bundle.frames);
  // The scale errs by disparities, which pictures that are off put off as well.
  motion.motion_covariance =
      doubt * pair.excess * (uncertainty.by_landmarks + uncertainty.by_scale) + uncertainty.byOffset();
  motion.motion_offset_error = uncertainty.offset_error;
  motion.deviation_by_landmarks = uncertainty.by_landmarks.diagonal().cwiseMax(0.0).cwiseSqrt();
  motion.guessed = doubt > 1.0;

  velocity_ = vectorFromMotion(motion.T_previous_current) / motion.time_step;
  last_deviation_ = motion.deviation_by_landmarks;
  noise_ = adapted(noise_, result);
  rig_ = learned;
  accept(pair, draft);
}

/// Landmarks get their new depths, and trust by how well they fit.
void VisualTrack::weigh(Draft& draft) const {
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    Landmark& landmark = draft.landmarks[chosen_[i]];
    const BundleLandmark& adjusted = bundle_.landmarks[i];
    const double ratio = adjusted.error / settings_.history.deviation;
    const double square = ratio * ratio;
    landmark.trust = 0.5 * (landmark.trust + 1.0 / (1.0 + square * square));
    if (!landmark.hasDepth() && !tellsDepth(adjusted)) continue;
    landmark.inverse_depth = adjusted.inverse_depth;
    landmark.information = adjusted.information;
    landmark.by_late_right = adjusted.by_late_right;
  }
  dropDistrusted(draft.landmarks, settings_.history.minimum_weight);
}

OdometryReason VisualTrack::judge(const TrackedMotion& motion, const Matrix6d& covariance) const {
  const ValiditySettings& validity = settings_.validity;
  if (!plausibleMotion(motion.T_previous_current, motion.time_step, validity))
    return OdometryReason::implausible_motion;
  if (!(covariance.diagonal().maxCoeff() <= std::pow(validity.maximum_deviation, 2)))
    return OdometryReason::degenerate_geometry;
  return OdometryReason::none;
}

/// What is known of the rig once the residuals of the adjusted pair, with `applied` corrected, are taken in.
RigMonitor VisualTrack::rigAfter(const BundleResult& result, const Draft& draft,
                                 const RigCorrection& applied) {
  RigMonitor rig = rig_;
  if (!result.converged || !corrects()) return rig;
  const double time_step = seconds(draft.window.back().exposure_ns - window_.back().exposure_ns);
  rig.add(bundle_, result, row_regression_.evidence(bundle_), applied, time_step);
  return rig;
}

}  // namespace cartvo
