// The window of `estimator: window` in a track: what it is told, and what follows from its trajectory.
#include <algorithm>

#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {
namespace {

constexpr double kKnownStddev = 1e-5;  // s, of a readout that is stated

}  // namespace

/// Knowledge of the cameras before a window: readouts and rig as estimated so far.
SharedPrior VisualTrack::sharedPrior(const PreparedPair& pair, const Estimates& estimates) const {
  const ReadoutEstimators& readouts = estimates.readouts;
  const SelfCalibrationSettings& settings = settings_.self_calibration;
  const RigStates rig = estimates.rig.states();
  SharedPrior prior;
  prior.mean << readouts.left.used(), readouts.right.used(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  if (timing_.mayRoll()) {
    prior.stddev[kLeftReadout] = std::max(readouts.left.stddev(), kKnownStddev);
    prior.stddev[kRightReadout] = std::max(readouts.right.stddev(), kKnownStddev);
  }
  prior.stddev[kOffset] = pair.offset_stddev;
  prior.drift[kOffset] = pair.offset_stddev > 0.0 ? settings.delay_drift : 0.0;
  if (!estimatesRig()) return prior;
  prior.mean.segment<3>(kPitch) << rig.pitch.value, rig.yaw.value, rig.roll.value;
  // Yaw and p2 change depths, and a short way shows little of them: they begin as in a good calibration.
  const double pattern = settings.yaw_pattern_stddev;
  prior.stddev.tail<kRigStates>() << rig.pitch.stddev, std::min(rig.yaw.stddev, pattern), rig.roll.stddev,
      pattern, settings.skew_stddev;
  prior.drift.segment<kRigStates>(kPitch).setConstant(settings.rotation_drift);
  prior.yaw_pattern = pattern;
  return prior;
}

/// Keeps references to the arguments.
TrackWindowInput VisualTrack::windowInput(const PreparedPair& pair, const SharedPrior& shared,
                                          const Estimates& estimates, const Draft& draft) const {
  std::optional<Vector6d> rest;
  if (standing_) rest = standstill_.covariance().diagonal().cwiseSqrt() / secondsSinceLast(pair);
  return {camera_,         timing_,      shared, estimates.still_regions,
          draft.landmarks, draft.window, rest,   settings_.self_calibration.correlated_pairs};
}

/// Sets the newest pair's pose, and where its right camera is, by its left positions: the right ones are
/// searched there.
void VisualTrack::predictByWindow(const PreparedPair& pair, Draft& draft) {
  const auto newest =
      track_window_.predict(windowInput(pair, sharedPrior(pair, estimates_), estimates_, draft));
  if (!newest) return;
  setFrame(*newest, draft.window.back());
  correctNewestRows(draft, newest->T_world_camera);
}

/// Sets a pair's pose, and its motions about both exposures.
void VisualTrack::setFrame(const TrackWindow::Pair& pair, WindowFrame& frame) const {
  frame.T_world_camera = pair.T_world_camera;
  frame.right = pair.right;
  if (!timing_.mayRoll()) return;
  frame.motion = pair.motion;
  frame.rows.emplace();
  frame.rows->expected_share.setZero();
  frame.rows->by_rows = vectorOf(*frame.motion);
}

/// Sets the readouts and the row shifts of the window by its trajectory.
void VisualTrack::timeByWindow(const TrackWindow::Adjusted& adjusted, Draft& draft) {
  draft.estimates.readouts.left.set(adjusted.estimate(kLeftReadout));
  draft.estimates.readouts.right.set(adjusted.estimate(kRightReadout));
  timing_.setReadouts(draft.estimates.readouts.left.used(), draft.estimates.readouts.right.used());
  const std::size_t older = draft.window.size() - adjusted.pairs.size();
  draft.estimates.prediction_errors.update(draft.predictions, *draft.window.back().motion);
  correctRows(camera_, timing_, draft.window, older, settings_.tracking.predicted_inverse_depth,
              draft.landmarks);
}

/// Replaces the adjusted poses, depths and covariances by those of the window of `estimator: window`. False
/// if its geometry is degenerate.
bool VisualTrack::adjustWindow(const PreparedPair& pair, Draft& draft, TrackedMotion& motion) {
  const auto adjusted =
      track_window_.adjust(windowInput(pair, sharedPrior(pair, draft.estimates), draft.estimates, draft));
  if (!adjusted) return false;
  const std::size_t older = draft.window.size() - adjusted->pairs.size();
  for (std::size_t i = 0; i < adjusted->pairs.size(); ++i) {
    setFrame(adjusted->pairs[i], draft.window[older + i]);
    draft.window[older + i].uncertainty.pose = adjusted->pairs[i].pose_covariance;
  }
  for (const auto& [index, inverse_depth] : adjusted->inverse_depths)
    draft.landmarks[index].inverse_depth = inverse_depth;
  if (timing_.mayRoll()) timeByWindow(*adjusted, draft);
  if (estimatesRig())
    draft.estimates.rig.set(
        {adjusted->estimate(kPitch), adjusted->estimate(kYaw), adjusted->estimate(kRoll)});
  motion.error = {};
  motion.error.by_landmarks = adjusted->motion_covariance;
  motion.error.codec_inflation = pair.pose_noise_inflation;
  motion.twist = ExposureTwist{adjusted->twist.value, adjusted->twist.covariance};
  return true;
}

}  // namespace cartvo::vo
