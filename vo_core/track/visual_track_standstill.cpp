// Standstill of a track: zero-velocity update and the check by the right camera.
#include <cmath>

#include "vo_core/estimation/pose_points.hpp"
#include "vo_core/self_calibration/newest_pair.hpp"
#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {

/// Zero-velocity update: the motion is zero and the pose is kept. Pairs of a standstill are compared with the
/// pairs before it and not added to the window, so that no drift accumulates however long the cart stands and
/// whatever drives past.
void VisualTrack::applyZeroVelocity(const PreparedPair& pair, TrackedMotion& motion) {
  motion.reason = OdometryReason::zero_velocity;
  motion.T_world_camera = window_.back().T_world_camera;
  motion.by_standstill = standstill_.motionCovariance();
  last_exposure_ns_ = pair.left_exposure_ns;
  // The last pair of the window was taken at this pose, too: the trajectory goes on from here.
  window_.back().exposure_ns = pair.left_exposure_ns;
}

/// Adds a pair of a standstill at the kept pose, with its new landmarks.
void VisualTrack::refreshStandstill(const PreparedPair& pair, Draft& draft, const TrackedMotion& motion) {
  WindowFrame& current = draft.window.back();
  current.T_world_camera = motion.T_world_camera;
  current.pose_covariance = window_.back().pose_covariance;
  current.motion = {};
  accept(pair, draft);
  frozen_camera_.reset();
  landmarks_when_stopped_ = countWithDepth(landmarks_);
}

/// Compares the pose found with the last one. Returns whether the left image shows a standstill; a motion
/// that its errors may explain is neither a standstill nor a motion.
bool VisualTrack::observeLeft(const Draft& draft, IntegrityEvidence& evidence) const {
  const Eigen::Isometry3d motion =
      window_.back().T_world_camera.inverse() * draft.window.back().T_world_camera;
  evidence.stands = !standstill_.exceedsLimits(motion);
  // The last pose errs as much as this one.
  evidence.moves = standstill_.isExceededBy(motion, 2.0 * draft.pose_covariance);
  return evidence.stands;
}

/// Localises the right camera of the window's last pair by its own image; empty if that fails. The anchors of
/// pose_problem_ are those of the landmarks.
std::optional<RightDisplacement> VisualTrack::localiseRight(const std::vector<WindowFrame>& window,
                                                            const std::vector<Landmark>& landmarks) {
  PoseProblem& problem = pose_problem_;
  problem.start = window.back().T_world_camera * rightFromLeft(window.back(), camera_.baseline).inverse();
  problem.expected = problem.start;
  toPosePoints(landmarks, window, camera_, problem.points, chosen_);
  toRightCameraPoints(landmarks, chosen_, camera_, estimates_.rig.correction(), problem.points);
  if (static_cast<int>(problem.points.size()) < settings_.validity.minimum_matches) return std::nullopt;
  SubsetRandom random(settings_.seed);  // not random_: the check must not change any motion
  const auto found = pose_finder_.find(problem, settings_.pose_search, random);
  if (!found || !hasEnoughInliers(*found, settings_.validity)) return std::nullopt;
  return RightDisplacement{problem.start.inverse() * found->T_world_camera, found->inliers,
                           pose_finder_.covarianceOf(problem, *found)};
}

/// Compares a left image without motion with the right camera: during a standstill, when a motion was
/// expected, and when the image equals the previous one.
void VisualTrack::checkRightCamera(const PreparedPair& pair, Draft& draft, IntegrityEvidence& evidence,
                                   StageObserver& observer) {
  const bool due = standing_ || frozen_camera_.isActive() || evidence.left_repeats ||
                   standstill_.exceedsLimits(window_.back().T_world_camera.inverse() * expectedPose(pair));
  if (!evidence.stands || !due) return frozen_camera_.reset();
  const StageScope stage(observer, Stage::disparity);
  pose_problem_.admissible_change = admissibleChange(pair);
  if (!frozen_camera_.isActive()) {
    const auto before = localiseRight(window_, landmarks_);
    if (!before) return;  // no right-camera pose: cannot cross-check
    const double offset = std::abs(draft.window.back().offset);
    frozen_camera_.start(*before, window_.back().exposure_ns,
                         2.0 * offset * velocity_.value_or(Vector6d::Zero()));
  }
  matchStereoRotated({tracker_, camera_, timing_, *pair.left, *pair.right, draft.window},
                     rightFromLeft(draft.window.back(), camera_.baseline), estimates_.rig, draft.landmarks);
  const RightMotion right = frozen_camera_.update(localiseRight(draft.window, draft.landmarks),
                                                  pair.left_exposure_ns, evidence.left_repeats);
  discardLastStereo(draft.landmarks);
  evidence.right_moves = right == RightMotion::moves;
  evidence.right_stays = right == RightMotion::stays;
}

/// Whether the evidence so far suffices to reject the pair; sets the reason.
bool VisualTrack::isRejected(const PreparedPair& pair, TrackedMotion& motion) const {
  const IntegrityAction action = decide(pair.state, motion.evidence).action;
  if (action == IntegrityAction::measure) return false;
  motion.reason = action == IntegrityAction::reject ? OdometryReason::repeated_picture
                                                    : OdometryReason::implausible_motion;
  return true;
}

}  // namespace cartvo::vo
