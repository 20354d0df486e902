// Bundle adjustment of a track's window: problem, rig calibration, covariances, validation.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "vo_core/estimation/bundle_noise.hpp"
#include "vo_core/estimation/window_problems.hpp"
#include "vo_core/estimation/window_uncertainty.hpp"
#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/plausible_motion.hpp"
#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {
namespace {

/// Difference of two corrections in normalised coordinates.
double differenceOf(const RigCorrection& a, const RigCorrection& b) {
  return std::abs(a.yaw - b.yaw) + std::abs(a.p2 - b.p2) + std::abs(a.pitch - b.pitch) +
         std::abs(a.roll - b.roll);
}

/// Error of a motion for one standard deviation of the readouts, from the motion that longer readouts make.
/// The scale of the map, which poses before the motion share, is part of it.
Vector6d errorByReadouts(const Eigen::Isometry3d& motion, const Eigen::Isometry3d& by_longer,
                         const ReadoutEstimators& readouts) {
  const double stddev = std::max(readouts.left.stddev(), readouts.right.stddev());
  Vector6d error = vectorFromMotion(motion.inverse() * by_longer);
  const Eigen::Vector3d by_scale = track_adjustment::kScaleByReadout * stddev * motion.translation();
  error.head<3>() += error.head<3>().dot(by_scale) < 0.0 ? -by_scale : by_scale;
  return error;
}

/// Sets priors on published, still free poses with `weight` times their information.
void addPosePriors(const std::vector<WindowFrame>& window, double weight, BundleProblem& problem) {
  problem.pose_prior_information.clear();
  for (std::size_t i = 0; i + 1 < window.size(); ++i) {
    Matrix6d& information = problem.pose_prior_information.emplace_back(Matrix6d::Zero());
    if (weight > 0.0 && static_cast<int>(i) >= problem.fixed)
      information = weight * window[i].local_covariance.ldlt().solve(Matrix6d::Identity());
  }
}

}  // namespace

void VisualTrack::buildBundleProblem(const Draft& draft, const RigCorrection& rig) {
  BundleProblem& problem = bundle_;
  problem.camera = camera_;
  problem.noise = noise_;
  problem.scale_stddev = settings_.uncertainty.scale_stddev;
  problem.poses = timedPoses(draft.window);
  const int poses = static_cast<int>(draft.window.size());
  problem.fixed = std::max(poses - settings_.bundle.free_frames,
                           std::min(poses - 1, track_adjustment::kMinimumFixedPoses));
  problem.fixed_pose_weight = settings_.bundle.fixed_pose_weight;
  addPosePriors(draft.window, settings_.bundle.prior_weight, problem);
  toBundleLandmarks(draft.landmarks, draft.window, camera_, rig, problem.landmarks, chosen_);
  for (BundleLandmark& landmark : problem.landmarks)
    landmark.weight *= cell_noise_.weightAt(camera_, landmark.observations.back().left);
}

/// Adjusts the window, and once more if the rig's correction changes by that: older poses are fixed, so that
/// a wrong scale would last as long as the window. Updates the rig.
BundleResult VisualTrack::adjustWithRig(Draft& draft) {
  RigCorrection rig = draft.estimates.rig.correction();
  buildBundleProblem(draft, rig);
  BundleResult result = adjuster_.adjust(bundle_, settings_.bundle);
  RigCalibrationFilter updated_rig = updatedRig(result, draft, rig);
  if (const RigCorrection better = updated_rig.correction();
      track_adjustment::kMinimumRigChange < camera_.focal_length * differenceOf(better, rig)) {
    rig = better;
    buildBundleProblem(draft, rig);
    result = adjuster_.adjust(bundle_, settings_.bundle);
    updated_rig = updatedRig(result, draft, rig);
  }
  draft.estimates.rig = updated_rig;
  return result;
}

/// The newest motion if both readouts were longer by one standard deviation: what they do to it is the
/// difference from the motion itself. Nothing if the adjustment does not converge.
std::optional<Eigen::Isometry3d> VisualTrack::motionByLongerReadouts(Draft& draft) {
  const auto factor_of = [](const ReadoutEstimator& readout) {
    const double share = readout.used() == 0.0 ? 0.0 : readout.stddev() / std::abs(readout.used());
    return static_cast<float>(1.0 + share);
  };
  const float left = factor_of(draft.estimates.readouts.left),
              right = factor_of(draft.estimates.readouts.right);
  kept_landmarks_ = draft.landmarks;
  for (Landmark& landmark : draft.landmarks) {
    for (Observation& observation : landmark.observations) {
      observation.left_row_shift *= left;
      observation.right_row_shift *= right;
    }
  }
  buildBundleProblem(draft, draft.estimates.rig.correction());
  draft.landmarks.swap(kept_landmarks_);
  if (!adjuster_.adjust(bundle_, settings_.bundle).converged) return std::nullopt;
  const auto& poses = bundle_.poses;
  return poses[poses.size() - 2].T_world_camera.inverse() * poses.back().T_world_camera;
}

/// The landmarks have the error of the readouts that they were seen with: it fades as other errors that
/// motions share do, and does not end with the uncertainty of the readouts.
void VisualTrack::keepReadoutError(Draft& draft, Vector6d& error) const {
  Vector6d& kept = draft.estimates.readout_error;
  kept *= std::exp(-1.0 / settings_.uncertainty.drift_correlation_pairs);
  error = (error.array().abs() < kept.array().abs()).select(kept, error);
  kept = error;
}

/// Whether so few landmarks match in stereo that these may do so by chance; sets the reason. The mean of the
/// share is updated by each motion that is valid otherwise.
bool VisualTrack::lacksStereo(TrackedMotion& motion) {
  const double share = static_cast<double>(motion.counts.stereo) / std::max(motion.counts.detected, 1);
  stereo_share_ += (share - stereo_share_) / settings_.self_calibration.correlated_pairs;
  if (stereo_share_ >= track_adjustment::kLeastStereoShare) return false;
  motion.reason = OdometryReason::too_few_matches;
  return true;
}

/// Adjusts the window and, if the motion is valid, accepts the draft.
void VisualTrack::adjust(const PreparedPair& pair, Draft& draft, TrackedMotion& motion) {
  draft.estimates = estimates_;
  std::optional<Matrix6d> by_rows;
  if (timing_.isRolling() && !usesWindow()) by_rows = estimateRowMotion(draft);
  std::optional<Eigen::Isometry3d> by_longer_readouts;
  if (draft.estimates.readouts.areUncertain() && !usesWindow())
    by_longer_readouts = motionByLongerReadouts(draft);
  const BundleResult result = adjustWithRig(draft);
  if (!result.converged) {
    motion.reason = OdometryReason::degenerate_geometry;
    return;
  }
  for (std::size_t i = 0; i < draft.window.size(); ++i)
    draft.window[i].T_world_camera = bundle_.poses[i].T_world_camera;
  updateLandmarks(draft);
  motion.error = updateUncertainties(
      bundle_, result, {overlap_.compute(bundle_), pair.pose_noise_inflation, pair.offset_stddev},
      settings_.uncertainty, draft.window);
  if (usesWindow() && !adjustWindow(pair, draft, motion)) {
    motion.reason = OdometryReason::degenerate_geometry;
    return;
  }
  motion.T_world_camera = draft.window.back().T_world_camera;
  motion.T_previous_current =
      draft.window[draft.window.size() - 2].T_world_camera.inverse() * motion.T_world_camera;
  if (draft.estimates.readouts.areUncertain() && !usesWindow()) {
    if (!by_longer_readouts) {
      motion.reason = OdometryReason::degenerate_geometry;
      return;
    }
    motion.error.by_readout =
        errorByReadouts(motion.T_previous_current, *by_longer_readouts, draft.estimates.readouts);
  }
  if (by_rows) concludeRowMotion(*by_rows, draft, motion);
  if (timing_.isRolling() && !usesWindow()) motion.error.by_rows += errorOfFirstRows(draft.window.size());
  motion.reason = validate(motion);
  if (!motion.valid() || stopsTooFast(pair, motion)) return;
  if (lacksStereo(motion)) return;
  if (!usesWindow())
    motion.error.startup_inflation = startupInflation(static_cast<int>(draft.window.size()) - 1,
                                                      settings_.bundle.frames, settings_.uncertainty);
  if (motion.twist)
    motion.twist->covariance += motion.error.offsetCovariance() / (motion.time_step * motion.time_step);

  velocity_ = vectorFromMotion(motion.T_previous_current) / motion.time_step;
  last_stddev_ = motion.stddevByPoses();
  keepReadoutError(draft, motion.error.by_readout);
  cell_noise_.update(bundle_);
  noise_ = adapted(noise_, result, settings_.self_calibration.correlated_pairs);
  if (timing_.mayRoll() && !usesWindow()) updateReadouts(draft);
  std::swap(estimates_, draft.estimates);
  if (usesWindow()) track_window_.accept();
  accept(pair, draft);
}

/// Updates the landmarks' depths, and their weights from their residuals; removes those with little weight.
/// Landmarks in still regions have no depth and so no say in the poses.
void VisualTrack::updateLandmarks(Draft& draft) {
  StillRegions& still_regions = draft.estimates.still_regions;
  still_regions.update(draft.landmarks, draft.window);
  const double memory = settings_.self_calibration.correlated_pairs;
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    Landmark& landmark = draft.landmarks[chosen_[i]];
    const BundleLandmark& adjusted = bundle_.landmarks[i];
    landmark.residuals.fade(memory);
    landmark.residuals.add(adjusted.error * adjusted.error);
    landmark.weight = std::min(1.0, landmark.residuals.weight(memory));
    if (still_regions.contains(landmark.last().left))
      landmark.information = 0.0;
    else
      updateDepth(adjusted, landmark);
  }
  std::erase_if(draft.landmarks,
                [&](const Landmark& landmark) { return landmark.weight < settings_.history.minimum_weight; });
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
  const Vector6d variances = motion.error.measured().diagonal();
  const double step = std::min(motion.time_step, track_adjustment::kLongestStep);
  const double gate = settings_.pose_search.maximum_acceleration * step * step;
  if (!variances.allFinite() || !(variances.maxCoeff() <= gate * gate))
    return OdometryReason::degenerate_geometry;
  return OdometryReason::none;
}

/// The rig filter updated with the residuals of the adjusted pair, whose right pixels were corrected by
/// `applied`; unchanged if it is off or the adjustment has not converged.
RigCalibrationFilter VisualTrack::updatedRig(const BundleResult& result, const Draft& draft,
                                             const RigCorrection& applied) {
  RigCalibrationFilter rig = draft.estimates.rig;
  if (!result.converged || !estimatesRig() || usesWindow()) return rig;
  const double time_step = secondsBetween(window_.back(), draft.window.back());
  rig.predict(time_step);
  rig.updateDisparities(bundle_, result, applied);
  rig.updateRows(row_regression_.measure(bundle_, rig.expectedRows(applied)));
  return rig;
}

}  // namespace cartvo::vo
