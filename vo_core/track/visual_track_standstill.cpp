// Standstill of a track: zero-velocity update and the check by the right camera.
#include <algorithm>
#include <cmath>

#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {
namespace {

// m and rad, standard deviations of a motion during a standstill.
constexpr double kStandstillTranslation = 3e-4, kStandstillRotation = 5e-5;
constexpr double kMotionSignificance = 5.0;  // standard deviations of a motion that is certain

}  // namespace

/// Zero-velocity update: the motion is zero and the pose is kept. Pairs of a standstill are compared with the
/// pairs before it and not added to the window, so that no drift accumulates however long the cart stands and
/// whatever drives past.
void VisualTrack::applyZeroVelocity(const PreparedPair& pair, TrackedMotion& motion) {
  motion.reason = OdometryReason::zero_velocity;
  motion.T_world_camera = window_.back().T_world_camera;
  motion.motion_covariance.setZero();
  motion.motion_covariance.diagonal()
      << Eigen::Vector3d::Constant(kStandstillTranslation * kStandstillTranslation),
      Eigen::Vector3d::Constant(kStandstillRotation * kStandstillRotation);
  last_exposure_ns_ = pair.left_exposure_ns;
}

/// Adds a pair of a standstill at the kept pose, with its new landmarks.
void VisualTrack::refreshStandstill(const PreparedPair& pair, Draft& draft, const TrackedMotion& motion) {
  WindowFrame& current = draft.window.back();
  current.T_world_camera = motion.T_world_camera;
  current.uncertainty = window_.back().uncertainty;
  current.dpose_doffset = window_.back().dpose_doffset;
  current.offset_error = window_.back().offset_error;
  current.local_covariance = motion.motion_covariance;
  if (timing_.isRolling()) {
    current.motion = ExposureMotion{};
    current.rows.reset();
  }
  accept(pair, draft);
  frozen_camera_.reset();
  landmarks_when_stopped_ = countWithDepth(landmarks_);
}

/// Whether the last velocity implies a motion beyond a standstill that exceeds its uncertainty clearly.
bool VisualTrack::expectsMotion(const PreparedPair& pair) const {
  if (!velocity_) return false;
  const Vector6d motion = secondsSinceLast(pair) * *velocity_;
  const auto is_significant = [&](const auto& part, const auto& stddev) {
    return part.norm() > kMotionSignificance * stddev.norm();
  };
  return standstill_.exceedsLimits(motionFromVector(motion)) &&
         (is_significant(motion.head<3>(), last_stddev_.head<3>()) ||
          is_significant(motion.tail<3>(), last_stddev_.tail<3>()));
}

/// Checks a left image without motion against the right camera: during a standstill, when a motion was
/// expected, and when the image equals the previous one.
void VisualTrack::checkRightCamera(const PreparedPair& pair, bool within_standstill, Draft& draft,
                                   StageObserver& observer) {
  const bool due = standing_ || frozen_camera_.isActive() || pair.repeats.left || expectsMotion(pair);
  if (!within_standstill || !due) return frozen_camera_.reset();
  const StageScope stage(observer, Stage::disparity);
  const double offset = std::abs(draft.window.back().offset);
  const Vector6d slack = 2.0 * offset * velocity_.value_or(Vector6d::Zero());
  frozen_camera_.update({{tracker_, camera_, timing_, *pair.left, *pair.right, draft.window},
                         pair.left_exposure_ns,
                         pair.repeats.left,
                         rig_,
                         noise_,
                         admissibleChange(pair),
                         slack.head<3>().norm(),
                         slack.tail<3>().norm()},
                        {window_, landmarks_}, draft.landmarks, {pose_problem_, chosen_, pose_finder_});
  discardLastStereo(draft.landmarks);
}

}  // namespace cartvo::vo
