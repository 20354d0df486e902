// Rolling shutters in a track: the motion about exposures and the row shifts that follow from it.
#include <algorithm>
#include <cmath>
#include <optional>

#include "vo_core/estimation/window_problems.hpp"
#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {
namespace {

// Pairs of a window from which rows are used: the depths of the first pair are those of an unknown motion
// between its exposures.
constexpr std::size_t kFirstWindow = 5;
// Pairs from one estimate of a readout to the next: of an unknown left one, and of all others.
constexpr int kUnknownReadoutInterval = 1, kReadoutInterval = 4;
// Pairs on each side of the one whose rows tell the readout: the polynomial through its neighbours is the
// better known motion, and a readout times a wrong motion would be a wrong readout.
constexpr int kReadoutNeighbours = 2;
static_assert(kFirstWindow > 2 * kReadoutNeighbours);
constexpr std::size_t kCorrectedPairs = 3;  // whose motions and row shifts are computed anew with each pair
static_assert(kCorrectedPairs > kReadoutNeighbours);

/// Change of a point's ray by a step of its anchor. Bearing and inverse depth remain those at z = 1.
Eigen::Vector3d rayByAnchorMotion(const Eigen::Isometry3d& T_camera_anchor, const Vector6d& step,
                                  const RowPoint& point) {
  const Eigen::Vector3d moved = step.tail<3>().cross(point.bearing) + point.inverse_depth * step.head<3>();
  return T_camera_anchor.linear() * (moved - moved.z() * point.bearing) -
         moved.z() * point.inverse_depth * T_camera_anchor.translation();
}

/// Motion between the exposures of two pairs as their motions about them make it, minus that of their poses
/// (trapezoidal rule with end correction).
Vector6d excessMotion(const WindowFrame& from, const WindowFrame& to) {
  const double time = secondsBetween(from, to);
  const Eigen::Isometry3d T_from_to = from.T_world_camera.inverse() * to.T_world_camera;
  const Vector6d step = vectorFromMotion(T_from_to);
  const auto turned = [&](const Vector6d& vector) {
    Vector6d result;
    result << T_from_to.linear() * vector.head<3>(), T_from_to.linear() * vector.tail<3>();
    return result;
  };
  Vector6d end_velocity = turned(to.motion->velocity);
  end_velocity.tail<3>() = rightJacobianOfRotation(step.tail<3>()).inverse() * to.motion->velocity.tail<3>();
  const Vector6d end_acceleration = turned(to.motion->acceleration);
  return 0.5 * time * (from.motion->velocity + end_velocity) +
         time * time / 12.0 * (from.motion->acceleration - end_acceleration) - step;
}

}  // namespace

/// Predicts the motion about the pair's exposure. Sets the readouts of the pair to the estimates.
void VisualTrack::predictMotion(const PreparedPair& pair, Draft& draft) {
  timing_.setReadouts(estimates_.rig.leftReadout(), estimates_.rig.rightReadout());
  MotionPredictions& predictions = draft.predictions;
  predictions.time_step = secondsSinceLast(pair);
  predictions.extrapolated = vectorOf(*window_.back().motion);
  predictions.extrapolated.head<6>() += predictions.time_step * predictions.extrapolated.segment<6>(6);
  predictions.extrapolated.tail<3>().setZero();
  predictions.mean.setZero();
  for (const WindowFrame& frame : window_)
    predictions.mean.head<6>() += frame.motion->velocity / static_cast<double>(window_.size());
  const PredictedMotion predicted = estimates_.prediction_errors.combine(predictions);
  predicted_variances_ = predicted.variances;
  WindowFrame& newest = draft.window.back();
  newest.motion = motionOf(predicted.motion);
  newest.rows = MotionBlend();
  newest.rows->expected_share.setZero();
  newest.rows->by_rows = predicted.motion;
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
  const RowInformation::Vector& variances = predicted_variances_;
  const double translation = variances.head<3>().mean(), rotation = variances.segment<3>(3).mean();
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    PosePoint& point = pose_problem_.points[i];
    const double instant = timing_.left(draft.landmarks[chosen_[i]].last().left);
    point.row_noise = camera_.focal_length * std::abs(instant) *
                      std::sqrt(rotation + point.inverse_depth * point.inverse_depth * translation);
  }
}

/// Sets the problem of the rows of the left image of a pair, `position` in the window.
void VisualTrack::buildRowProblem(const Draft& draft, int position, const ExposureMotion& expected,
                                  const RowInformation::Vector& variances) {
  RowMotionProblem& problem = row_problem_;
  problem.camera = camera_;
  problem.noise = noise_;
  problem.robust_width = settings_.bundle.robust_width;
  problem.depth_scale_stddev = settings_.uncertainty.scale_stddev;
  problem.settings = settings_.rolling_shutter;
  problem.expected = expected;
  problem.variances = variances;
  problem.readout_stddev = draft.estimates.rig.leftReadoutStddev();
  addRowPoints(draft, position, draft.window[position].T_world_camera, RigSide::left);
}

/// Fills the points of the problem for a camera of the pair at `position` in the window, at `T_world_camera`.
/// The left camera's readout timed the anchors, too: a steady turn shears all its images alike, so that only
/// points whose rows change tell the readout.
void VisualTrack::addRowPoints(const Draft& draft, int position, const Eigen::Isometry3d& T_world_camera,
                               RigSide side) {
  std::vector<RowPoint>& points = row_problem_.points;
  points.clear();
  points.reserve(draft.landmarks.capacity());
  FixedVector<Eigen::Isometry3d, kMaximumWindowPairs> T_camera_anchor;
  for (const WindowFrame& frame : draft.window)
    T_camera_anchor.push_back(T_world_camera.inverse() * frame.T_world_camera);
  const RigCorrection rig = draft.estimates.rig.correction();
  for (const Landmark& landmark : draft.landmarks) {
    if (!landmark.hasDepth() || landmark.observations.size() < 2) continue;
    const Observation* seen = landmark.find(draft.window[position].index);
    const std::optional<int> anchor = findFrameIndex(draft.window, landmark.anchor().frame);
    if (!anchor || *anchor == position || seen == nullptr) continue;
    RowPoint point;
    if (side == RigSide::left) {
      point.pixel = seen->left;
      point.instant = timing_.left(seen->left);
      point.share = timing_.leftShare(seen->left);
    } else {
      if (!seen->stereo) continue;
      point.pixel = correctedRight(camera_, rig, seen->right());
      point.instant = timing_.right(seen->right());
      point.share = timing_.rightShare(seen->right());
    }
    const Eigen::Isometry3d& T = T_camera_anchor[*anchor];
    point.bearing = bearingOf(camera_, landmark.anchor().leftAtExposure());
    point.ray = T.linear() * point.bearing + landmark.inverse_depth * T.translation();
    point.ray_by_inverse_depth = T.translation();
    point.inverse_depth = landmark.inverse_depth;
    if (side == RigSide::left) {
      const Vector6d& velocity = draft.window[*anchor].motion->velocity;
      const Vector6d moved = timing_.leftShare(landmark.anchor().left) * velocity;
      point.ray_by_readout = rayByAnchorMotion(T, moved, point);
    }
    point.inverse_depth_information = landmark.information;
    point.relative_noise = seen->relative_noise;
    point.weight = landmark.poseWeight();
    point.level = landmark.level;
    points.push_back(point);
  }
}

/// Estimates the newest pair's motion from the rows of its left image, the readouts, and from them all row
/// shifts of the window. Returns what the motion about the exposure adds to the covariance of its pose;
/// nothing in a short window, or if the rows tell no motion.
std::optional<Matrix6d> VisualTrack::estimateRowMotion(Draft& draft) {
  const TimedPoses poses = timedPoses(draft.window);
  const int newest = static_cast<int>(poses.size()) - 1;
  MotionRoughness& roughness = draft.estimates.roughness;
  const bool enough_pairs = draft.window.size() >= kFirstWindow;
  if (enough_pairs) roughness.update(poses, last_stddev_);
  buildRowProblem(draft, newest, motionByPoses(poses, newest),
                  roughness.variances(poses, newest, last_stddev_));
  row_problem_.start = *draft.window.back().motion;
  const RowMotion found = row_motion_.estimate(row_problem_);
  const bool use = found.converged && enough_pairs;
  if (use) {
    // The landmarks' bearings were moved by the motions about earlier exposures, whose errors are alike.
    const WindowFrame& before = draft.window[draft.window.size() - 2];
    draft.window.back().row_information =
        before.rows ? withMapError(found.rows, before.rows->covariance) : found.rows;
  }
  const std::size_t first = firstToCorrect(draft.window);
  for (int i = static_cast<int>(first); i <= newest; ++i)
    updateMotion(poses, i, last_stddev_, draft);
  draft.estimates.prediction_errors.update(draft.predictions, *draft.window.back().motion);
  if (use) {
    updateRowConsistency(draft);
    updateReadouts(draft, poses);
  }
  timing_.setReadouts(draft.estimates.rig.leftReadout(), draft.estimates.rig.rightReadout());
  correctRows(camera_, timing_, draft.window, first, settings_.tracking.predicted_inverse_depth,
              draft.landmarks);
  return use ? std::optional(found.pose_covariance_by_motion) : std::nullopt;
}

/// Compares the motions about the last two exposures with the motion between their poses: the errors that the
/// rows of several pictures have in common are not part of their covariances.
void VisualTrack::updateRowConsistency(Draft& draft) const {
  const WindowFrame &from = draft.window[draft.window.size() - 2], &to = draft.window.back();
  const double step = secondsBetween(from, to);
  const Vector6d velocity_variances =
      from.rows->covariance.diagonal().head<6>() + to.rows->covariance.diagonal().head<6>();
  draft.estimates.roughness.compare(excessMotion(from, to),
                                    0.25 * step * step * velocity_variances + last_stddev_.cwiseAbs2());
}

/// Updates the motion about the newest exposure by the adjusted poses, and sets the twist. Widens its
/// covariance and what the motion adds to that of the pose, `by_rows`, as far as the rows have been
/// inconsistent.
void VisualTrack::concludeRowMotion(const Matrix6d& by_rows, Draft& draft, TrackedMotion& motion) const {
  WindowFrame& pair = draft.window.back();
  updateMotion(timedPoses(draft.window), static_cast<int>(draft.window.size()) - 1,
               motion.stddevByLandmarks(), draft);
  const double factor = draft.estimates.roughness.varianceFactor();
  motion.twist = ExposureTwist{pair.motion->velocity, factor * pair.rows->covariance.topLeftCorner<6, 6>()};
  motion.error.by_rows = factor * by_rows;
}

/// Position in the window of the first pair whose motion and row shifts are not up to date: older poses and
/// motions hardly change, unless the rows tell the readout.
std::size_t VisualTrack::firstToCorrect(const std::vector<WindowFrame>& window) const {
  const bool all_change = timing_.shutters().areUncertain();
  return all_change || window.size() < kCorrectedPairs ? 0 : window.size() - kCorrectedPairs;
}

/// Updates the readouts by the rows of a pair in the middle of the window, weighted by the square of the
/// poses' least share in the motions since: where the poses tell a motion badly, its error would pass for one
/// of the readout, and in a vibration always with the same sign.
void VisualTrack::updateReadouts(Draft& draft, const TimedPoses& poses) {
  const int position = static_cast<int>(draft.window.size()) - 1 - kReadoutNeighbours;
  const WindowFrame& frame = draft.window[position];
  RigCalibrationFilter& rig = draft.estimates.rig;
  double share_of_poses = 1.0;
  for (std::size_t i = position; i < draft.window.size(); ++i)
    share_of_poses =
        std::min(share_of_poses, draft.window[i].rows->expected_share.diagonal().head<6>().minCoeff());
  const double weight = std::pow(std::max(share_of_poses, 0.0), 2);
  const bool right_is_due = frame.index % kReadoutInterval == 0;
  const int left_interval = rig.leftReadoutStddev() > 0.0 ? kUnknownReadoutInterval : kReadoutInterval;
  if (frame.index % left_interval != 0) return;
  const ExposureMotion expected =
      motionByPolynomial(poses, position, position - kReadoutNeighbours, position + kReadoutNeighbours);
  buildRowProblem(draft, position, expected,
                  draft.estimates.roughness.variances(poses, position, last_stddev_));
  row_problem_.start = expected;
  if (const RowMotion found = row_motion_.estimate(row_problem_); found.converged)
    rig.updateLeftReadout(found.readout, weight * left_interval);
  if (!right_is_due) return;
  const Eigen::Isometry3d T_left_right = leftFromRight(camera_.baseline);
  row_problem_.expected = row_problem_.start =
      motionAbout(expected, frame.offset, T_left_right, timing_.range());
  row_problem_.readout_stddev = rig.rightReadoutStddev();
  addRowPoints(draft, position, frame.T_world_camera * expected.at(frame.offset) * T_left_right,
               RigSide::right);
  if (const RowMotion found = row_motion_.estimate(row_problem_); found.converged)
    rig.updateRightReadout(found.readout, weight * kReadoutInterval);
}

/// Updates the motion about the exposure of the pair at `position` in the window: that of the poses and of
/// the pair's rows, each by its covariance.
void VisualTrack::updateMotion(const TimedPoses& poses, int position, const Vector6d& motion_stddev,
                               Draft& draft) const {
  WindowFrame& pair = draft.window[position];
  const ExposureMotion expected = motionByPoses(poses, position);
  const MotionPrior prior{vectorOf(expected),
                          draft.estimates.roughness.variances(poses, position, motion_stddev),
                          settings_.rolling_shutter.prior_freedom};
  pair.rows.emplace(pair.row_information, prior);
  pair.motion = pair.rows->of(expected);
}

}  // namespace cartvo::vo
