// Adjustment of a track's window: what it is told, what follows from it, validation.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/statistics.hpp"
#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/plausible_motion.hpp"
#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {
namespace {

// s, of exact time stamps, and of the readout of a global shutter: images of hours do not outweigh it.
constexpr double kKnownStddev = 1e-8;
// m^2, of a stddev of 0.05 / m: a depth from motion that is more certain than this is used.
constexpr double kCertainInformation = 400.0;

/// Information of the images alone on a state, and its product with their difference from the mean.
struct OfImages {
  double information, vector;
};

/// `found`: with a prior of the stddev `told` about `mean`.
OfImages ofImages(const EstimateWithStddev& found, double mean, double told) {
  const double information = 1.0 / (found.stddev * found.stddev);
  return {information - 1.0 / (told * told), information * (found.value - mean)};
}

/// The estimate that a prior with the stddev `wide` would have given instead of one with `told`, both about
/// `mean`: what the images alone say of a state that is known.
EstimateWithStddev withWiderPrior(const EstimateWithStddev& found, double mean, double told, double wide) {
  const OfImages images = ofImages(found, mean, told);
  const double information = std::max(0.0, images.information) + 1.0 / (wide * wide);
  return {mean + images.vector / information, 1.0 / std::sqrt(information)};
}

/// Whether the odds are for a stddev `wide` of a state about `mean` rather than `narrow`, by what the images
/// alone say. `found`: with a prior of the stddev `told`. Not if the images say less than `wide`, nor if
/// `told` is another prior: that of a state that has been measured hides by rounding what one pair says.
bool contradicts(const EstimateWithStddev& found, double mean, double told, double narrow, double wide) {
  const OfImages images = ofImages(found, mean, told);
  if (2.0 * told < narrow || told > narrow || !(images.information * wide * wide > 1.0)) return false;
  const double change = images.vector / images.information;
  const auto log_likelihood = [&](double stddev) {
    const double variance = 1.0 / images.information + stddev * stddev;
    return -0.5 * (change * change / variance + std::log(variance));
  };
  return log_likelihood(wide) - log_likelihood(narrow) > track_start::kEstablished;
}

/// The covariance, inflated along each axis as far as earlier estimates were wrong. A vibration near half the
/// frame rate is not the white jerk of the trajectory: errors beyond their deviations then follow each other.
Matrix6d inflated(const Matrix6d& covariance, const AxisErrors& errors, double memory) {
  Vector6d widths;
  for (int axis = 0; axis < 6; ++axis)
    widths[axis] = std::sqrt(std::max(1.0, 1.0 / errors[static_cast<std::size_t>(axis)].weight(memory)));
  return widths.asDiagonal() * covariance * widths.asDiagonal();
}

/// Adds the change of an estimate that a later pair has made, and removed variance by.
void addChange(const Vector6d& change, const Matrix6d& before, const Matrix6d& now, double memory,
               AxisErrors& errors) {
  constexpr double kLeastShare = 0.25;  // of the variance that a later pair removes
  const Vector6d removed = (before - now).diagonal().cwiseMax(kLeastShare * before.diagonal());
  for (int axis = 0; axis < 6; ++axis) {
    ResidualVariance& error = errors[static_cast<std::size_t>(axis)];
    error.fade(memory);
    error.add(change[axis] * change[axis] / removed[axis]);
  }
}

}  // namespace

/// Knowledge of the cameras before a window: readouts and rig as estimated so far.
SharedPrior VisualTrack::sharedPrior(const PreparedPair& pair, const Estimates& estimates) const {
  const SelfCalibrationSettings& settings = settings_.self_calibration;
  const auto& [left, right] = estimates.readouts;
  const RigStates& rig = estimates.rig.states();
  SharedPrior prior;
  prior.mean << left.value, right.value, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  prior.stddev.head<kOffset>() << std::max(left.stddev, kKnownStddev), std::max(right.stddev, kKnownStddev);
  prior.stddev[kOffset] = std::max(pair.offset_stddev, kKnownStddev);
  prior.drift[kOffset] = pair.offset_stddev > 0.0 ? settings.delay_drift : 0.0;
  if (!estimatesRig()) return prior;
  prior.mean.segment<3>(kPitch) << rig.pitch.value, rig.yaw.value, rig.roll.value;
  const double pattern = settings.yaw_pattern_stddev;
  prior.stddev.tail<kRigStates>() << rig.pitch.stddev, estimates.rig.priorYawStddev(), rig.roll.stddev,
      pattern, settings.skew_stddev;
  prior.drift.segment<kRigStates>(kPitch).setConstant(settings.rotation_drift);
  prior.yaw_pattern = pattern;
  return prior;
}

/// Keeps references to the arguments.
TrackWindowInput VisualTrack::windowInput(const PreparedPair& pair, const SharedPrior& shared,
                                          const Draft& draft) const {
  std::optional<Vector6d> rest;
  if (standing_) rest = standstill_.covariance().diagonal().cwiseSqrt() / secondsSinceLast(pair);
  return {camera_,         timing_,      shared, estimates_.still_regions,
          draft.landmarks, draft.window, rest,   settings_.self_calibration.correlated_pairs};
}

/// Sets the newest pair's pose, and where its right camera is, by its left positions: the right ones are
/// searched there.
void VisualTrack::predictByWindow(const PreparedPair& pair, Draft& draft) {
  const auto newest = track_window_.predict(windowInput(pair, sharedPrior(pair, estimates_), draft));
  if (!newest) return;
  WindowFrame& frame = draft.window.back();
  frame.motion = newest->motion;
  frame.right = newest->right;
  frame.T_world_camera = newest->T_world_camera;
  correctNewestRows(draft, newest->T_world_camera);
}

/// Adjusts the window and, if the motion is valid, accepts the draft.
void VisualTrack::adjust(const PreparedPair& pair, Draft& draft, TrackedMotion& motion) {
  draft.estimates = estimates_;
  SharedPrior prior = sharedPrior(pair, estimates_);
  auto adjusted = track_window_.adjust(windowInput(pair, prior, draft));
  if (adjusted && (restartAfterBump(draft) || restartWithOpenYaw(*adjusted, prior, draft))) {
    prior = sharedPrior(pair, draft.estimates);
    adjusted = track_window_.adjust(windowInput(pair, prior, draft));
  }
  if (!adjusted || !adjusted->explained) {
    motion.reason = OdometryReason::degenerate_geometry;
    return;
  }
  useAdjusted(*adjusted, prior, draft);
  WindowFrame& newest = draft.window.back();
  newest.pose_covariance *= pair.pose_noise_inflation;
  motion.T_world_camera = newest.T_world_camera;
  motion.T_previous_current =
      draft.window[draft.window.size() - 2].T_world_camera.inverse() * motion.T_world_camera;
  const double memory = settings_.self_calibration.correlated_pairs;
  const Estimates& estimates = draft.estimates;
  motion.by_window = inflated(adjusted->motion.covariance, estimates.motion_errors, memory);
  motion.codec_inflation = pair.pose_noise_inflation;
  motion.noise_is_uncalibrated = static_cast<int>(draft.window.size()) <= settings_.window.pairs;
  motion.twist = adjusted->twist;
  for (Matrix6d* const covariance : {&motion.twist->covariance, &motion.twist->acceleration_covariance})
    *covariance = pair.pose_noise_inflation * inflated(*covariance, estimates.twist_errors, memory);
  motion.reason = validate(motion);
  if (!motion.valid() || stopsTooFast(pair, motion)) return;
  if (lacksStereo(motion)) return;

  addStartUncertainty(motion);
  velocity_ = vectorFromMotion(motion.T_previous_current) / motion.time_step;
  timing_.use(draft.estimates.readouts);
  if (timing_.isRolling())
    correctRows(camera_, timing_, draft.window, draft.window.size() - adjusted->pairs.size(),
                settings_.tracking.predicted_inverse_depth, draft.landmarks);
  std::swap(estimates_, draft.estimates);
  track_window_.accept();
  accept(pair, draft);
}

/// Whether the right camera has been turned since the last pair: the rows of most of its matches are
/// displaced, by no more than is corrected. The window then begins anew, without the right positions seen
/// before; the draft has the new pitch.
bool VisualTrack::restartAfterBump(Draft& draft) {
  if (!estimatesRig()) return false;
  right_rows_.clear();
  for (const TrackWindow::AdjustedLandmark& adjusted : track_window_.landmarks())
    if (draft.landmarks[adjusted.index].last().stereo) right_rows_.push_back(adjusted.fit.right_row);
  if (static_cast<int>(right_rows_.size()) < settings_.validity.minimum_matches) return false;
  const double noise = stereo_look::kRowNoise / camera_.focal_length;  // rad
  const double turned = median(right_rows_) / camera_.focal_length;
  const double pitch = estimates_.rig.states().pitch.value + turned;
  if (std::abs(turned) < 2.0 * noise || std::abs(pitch) > pitch_search::kMaximumPitch) return false;
  draft.estimates.rig.reinitialisePitch({pitch, noise});
  for (Landmark& landmark : draft.landmarks)
    for (Observation& observation : landmark.observations)
      if (observation.frame != draft.window.back().index) observation.stereo = false;
  track_window_.forget();
  return true;
}

/// Whether the images contradict the yaw that the window began with. The window then begins anew.
bool VisualTrack::restartWithOpenYaw(const TrackWindow::Adjusted& adjusted, const SharedPrior& prior,
                                     Draft& draft) {
  if (!estimatesRig() || !contradicts(adjusted.estimate(kYaw), prior.mean[kYaw], prior.stddev[kYaw],
                                      prior.yaw_pattern, settings_.self_calibration.calibration_stddev))
    return false;
  draft.estimates.rig.openYaw();
  track_window_.forget();
  return true;
}

/// Sets poses, motions, landmarks and the estimates about the cameras to those of the adjusted window.
void VisualTrack::useAdjusted(const TrackWindow::Adjusted& adjusted, const SharedPrior& prior, Draft& draft) {
  const std::size_t older = draft.window.size() - adjusted.pairs.size();
  for (std::size_t i = 0; i < adjusted.pairs.size(); ++i) {
    const TrackWindow::Pair& pair = adjusted.pairs[i];
    WindowFrame& frame = draft.window[older + i];
    frame.T_world_camera = pair.T_world_camera;
    frame.pose_covariance = pair.pose_covariance;
    frame.motion = pair.motion;
    frame.right = pair.right;
  }
  updateLandmarks(draft);
  Estimates& estimates = draft.estimates;
  estimates.prediction_errors.update(draft.predictions, draft.window.back().motion);
  updateErrors(adjusted, estimates);
  const SelfCalibrationSettings& settings = settings_.self_calibration;
  // A pair's landmarks have a part of their errors in common, which does not average out.
  constexpr double kCoordinates = 4.0;  // of a landmark
  const double shared = std::sqrt(1.0 + landmark_errors::kSharedVariance * kCoordinates *
                                            static_cast<double>(track_window_.landmarks().size()));
  const auto readout_of = [&](SharedState state) {
    EstimateWithStddev readout = adjusted.estimate(state);
    readout.stddev = std::min(shared * readout.stddev, prior.stddev[state]);
    return readout;
  };
  if (timing_.mayRoll()) estimates.readouts = {readout_of(kLeftReadout), readout_of(kRightReadout)};
  if (!estimatesRig()) return;
  EstimateWithStddev delay = adjusted.estimate(kOffset);
  if (const double known = prior.stddev[kOffset]; known == kKnownStddev)
    delay = withWiderPrior(delay, 0.0, known, settings.delay_stddev);
  estimates.rig.set({adjusted.estimate(kPitch), adjusted.estimate(kYaw), adjusted.estimate(kRoll), delay});
}

/// Compares the last motion and twist with what they are now that a later pair is known.
void VisualTrack::updateErrors(const TrackWindow::Adjusted& adjusted, Estimates& estimates) const {
  const double memory = settings_.self_calibration.correlated_pairs;
  const auto twist = std::exchange(estimates.twist, adjusted.twist);
  const auto motion = std::exchange(estimates.motion, adjusted.motion);
  if (!twist || standing_ || !adjusted.motion_before) return;
  const ExposureTwist& twist_now = adjusted.twist_before;
  addChange(twist->value - twist_now.value, twist->covariance, twist_now.covariance, memory,
            estimates.twist_errors);
  const WindowMotion& motion_now = *adjusted.motion_before;
  addChange(vectorFromMotion(motion->value.inverse() * motion_now.value), motion->covariance,
            motion_now.covariance, memory, estimates.motion_errors);
}

/// Updates the landmarks' depths, and their weights from their residuals; removes those with little weight.
/// Landmarks in still regions have no depth and so no say in the poses.
void VisualTrack::updateLandmarks(Draft& draft) {
  StillRegions& still_regions = draft.estimates.still_regions;
  still_regions.update(draft.landmarks, draft.window);
  const double memory = settings_.self_calibration.correlated_pairs;
  for (const TrackWindow::AdjustedLandmark& adjusted : track_window_.landmarks()) {
    Landmark& landmark = draft.landmarks[adjusted.index];
    landmark.residuals.fade(memory);
    landmark.residuals.add(landmark.last().outlier ? std::pow(kWideGate * settings_.pose_search.gate, 2)
                                                   : adjusted.fit.square);
    landmark.weight = std::min(1.0, landmark.residuals.weight(memory));
    const double information = adjusted.fit.information;
    if (!(information > 0.0) || (!landmark.hasDepth() && information < kCertainInformation)) continue;
    landmark.inverse_depth = adjusted.inverse_depth;
    landmark.information = information;
  }
  for (Landmark& landmark : draft.landmarks)
    if (landmark.observations.size() > 1 && still_regions.contains(landmark.last().left))
      landmark.information = 0.0;
  std::erase_if(draft.landmarks,
                [&](const Landmark& landmark) { return landmark.weight < settings_.history.minimum_weight; });
}

/// Whether so few landmarks match in stereo that these may do so by chance; sets the reason. The mean of the
/// share is updated by each motion that is valid otherwise.
bool VisualTrack::lacksStereo(TrackedMotion& motion) {
  const double share = static_cast<double>(motion.counts.stereo) / std::max(motion.counts.detected, 1);
  stereo_share_ += (share - stereo_share_) / settings_.self_calibration.correlated_pairs;
  if (stereo_share_ >= pitch_search::kFewMatchesShare) return false;
  motion.reason = OdometryReason::too_few_matches;
  return true;
}

/// Whether the adjusted motion is a stop that the pair's evidence excludes; sets the reason.
bool VisualTrack::stopsTooFast(const PreparedPair& pair, TrackedMotion& motion) const {
  if (standstill_.exceedsLimits(motion.T_previous_current, track_adjustment::kStopTolerance)) return false;
  motion.evidence.stands = true;
  motion.evidence.moves = false;
  return isRejected(pair, motion);
}

OdometryReason VisualTrack::validate(const TrackedMotion& motion) const {
  const ValiditySettings& validity = settings_.validity;
  if (!isPlausibleMotion(motion.T_previous_current, motion.time_step, validity))
    return OdometryReason::implausible_motion;
  // A motion whose uncertainty exceeds what the cart's acceleration could change is no measurement.
  const Vector6d variances = motion.by_window.diagonal();
  const double step = std::min(motion.time_step, track_adjustment::kLongestStep);
  const double gate = settings_.pose_search.maximum_acceleration * step * step;
  if (!variances.allFinite() || !(variances.maxCoeff() <= gate * gate))
    return OdometryReason::degenerate_geometry;
  return OdometryReason::none;
}

}  // namespace cartvo::vo
