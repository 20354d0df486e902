// Rolling shutters in a track: the motion about exposures and the row shifts that follow from it.
#include <algorithm>
#include <cmath>
#include <optional>

#include "vo_core/estimation/window_problems.hpp"
#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {
namespace {

constexpr std::size_t kCorrectedPairs = 3;  // whose motions and row shifts are computed anew with each pair

/// Change of a point's ray by a step of its anchor. Bearing and inverse depth remain those at z = 1.
Eigen::Vector3d rayByAnchorMotion(const Eigen::Isometry3d& T_camera_anchor, const Vector6d& step,
                                  const RowPoint& point) {
  const Eigen::Vector3d moved = step.tail<3>().cross(point.bearing) + point.inverse_depth * step.head<3>();
  return T_camera_anchor.linear() * (moved - moved.z() * point.bearing) -
         moved.z() * point.inverse_depth * T_camera_anchor.translation();
}

/// Sets what follows from a point's bearing and inverse depth in its anchor camera, which `step` moves by for
/// each second of readout, and what its landmark and the observation `seen` state.
void complete(const Eigen::Isometry3d& T_camera_anchor, const Vector6d& step, const Landmark& landmark,
              const Observation& seen, RowPoint& point) {
  point.ray = T_camera_anchor.linear() * point.bearing + point.inverse_depth * T_camera_anchor.translation();
  point.ray_by_inverse_depth = T_camera_anchor.translation();
  point.ray_by_readout = rayByAnchorMotion(T_camera_anchor, step, point);
  point.inverse_depth_information = landmark.information;
  point.relative_noise = seen.relative_noise;
  point.weight = landmark.poseWeight();
  point.level = landmark.level;
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

/// Predicts the motion about the pair's exposure.
void VisualTrack::predictMotion(const PreparedPair& pair, Draft& draft) {
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

/// Sets all of a row problem but its points.
void VisualTrack::setRowProblem(const ExposureMotion& expected, const RowInformation::Vector& variances) {
  RowMotionProblem& problem = row_problem_;
  problem.camera = camera_;
  problem.noise = noise_;
  problem.robust_width = settings_.bundle.robust_width;
  problem.depth_scale_stddev = settings_.uncertainty.scale_stddev;
  problem.settings = settings_.rolling_shutter;
  problem.expected = expected;
  problem.variances = variances;
}

/// Fills the points of the problem for the left camera of the newest pair. The left camera's readout timed
/// the anchors, too.
void VisualTrack::addRowPoints(const Draft& draft) {
  std::vector<RowPoint>& points = row_problem_.points;
  points.clear();
  points.reserve(draft.landmarks.capacity());
  const WindowFrame& newest = draft.window.back();
  FixedVector<Eigen::Isometry3d, kMaximumWindowPairs> T_camera_anchor;
  for (const WindowFrame& frame : draft.window)
    T_camera_anchor.push_back(newest.T_world_camera.inverse() * frame.T_world_camera);
  for (const Landmark& landmark : draft.landmarks) {
    if (!landmark.hasDepth() || landmark.observations.size() < 2) continue;
    const Observation* seen = landmark.find(newest.index);
    const std::optional<int> anchor = findFrameIndex(draft.window, landmark.anchor().frame);
    if (!anchor || seen == nullptr) continue;
    RowPoint point;
    point.pixel = seen->left;
    point.instant = timing_.left(seen->left);
    point.share = timing_.leftShare(seen->left);
    point.bearing = bearingOf(camera_, landmark.anchor().leftAtExposure());
    point.inverse_depth = landmark.inverse_depth;
    const Vector6d& velocity = draft.window[*anchor].motion->velocity;
    complete(T_camera_anchor[*anchor], timing_.leftShare(landmark.anchor().left) * velocity, landmark, *seen,
             point);
    points.push_back(point);
  }
}

/// Estimates the newest pair's motion from the rows of its left image, and from it the row shifts of the
/// window. Returns what the motion about the exposure adds to the covariance of its pose; nothing in a short
/// window, or if the rows tell no motion.
std::optional<Matrix6d> VisualTrack::estimateRowMotion(Draft& draft) {
  const TimedPoses poses = timedPoses(draft.window);
  const int newest = static_cast<int>(poses.size()) - 1;
  MotionRoughness& roughness = draft.estimates.roughness;
  const bool enough_pairs = draft.window.size() >= track_rows::kFirstWindow;
  if (enough_pairs) roughness.update(poses, last_stddev_);
  setRowProblem(motionByPoses(poses, newest), roughness.variances(poses, newest, last_stddev_));
  addRowPoints(draft);
  row_problem_.start = *draft.window.back().motion;
  const RowMotion found = row_motion_.estimate(row_problem_);
  // With a wrong readout, rows confirm the motion with which their map was made, even against the poses.
  const bool use = found.converged && enough_pairs && !draft.estimates.readouts.left.isUnknown();
  if (use) {
    // The landmarks' bearings were moved by the motions about earlier exposures, whose errors are alike.
    const WindowFrame& before = draft.window[draft.window.size() - 2];
    RowInformation::Matrix common = RowInformation::Matrix::Zero();
    if (before.rows) common = before.rows->covariance;
    const RowInformation::Vector by_readout = draft.estimates.readouts.left.stddev() * found.error_by_readout;
    common += by_readout * by_readout.transpose();
    draft.window.back().row_information = withMapError(found.rows, common);
  }
  const std::size_t first = firstToCorrect(draft.window);
  for (int i = static_cast<int>(first); i <= newest; ++i)
    updateMotion(poses, i, last_stddev_, draft);
  draft.estimates.prediction_errors.update(draft.predictions, *draft.window.back().motion);
  if (use) updateRowConsistency(draft);
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
  updateMotion(timedPoses(draft.window), static_cast<int>(draft.window.size()) - 1, motion.stddevByPoses(),
               draft);
  const double factor = draft.estimates.roughness.varianceFactor();
  motion.twist = ExposureTwist{pair.motion->velocity, factor * pair.rows->covariance.topLeftCorner<6, 6>()};
  motion.error.by_rows = factor * by_rows;
}

/// Covariance that the unknown motion about a track's first exposures adds to that of a motion: rows were
/// moved by a speed and a rate that were not known.
Matrix6d VisualTrack::errorOfFirstRows(std::size_t pairs) const {
  if (pairs >= track_rows::kFirstWindow || pairs < 2) return Matrix6d::Zero();
  const double time = 2.0 * timing_.range() * track_rows::kRowShare / static_cast<double>(pairs - 1);
  Vector6d stddev = Vector6d::Constant(time * settings_.rolling_shutter.unknown_velocity);
  stddev.tail<3>().setConstant(time * settings_.self_calibration.unknown_rate_stddev);
  return stddev.cwiseAbs2().asDiagonal();
}

/// Position in the window of the first pair whose motion and row shifts are not up to date: older poses and
/// motions hardly change.
std::size_t VisualTrack::firstToCorrect(const std::vector<WindowFrame>& window) const {
  return window.size() < kCorrectedPairs ? 0 : window.size() - kCorrectedPairs;
}

/// Equation for a camera's readout by its rows: its image of the pair at `position` in the window against
/// its image two pairs before, each row at its own instant in the motion that the polynomials through the
/// poses make. Both images are timed with the same readout, so that a steady turn, which shears all images
/// alike, tells nothing. Nothing if too few landmarks are seen in both.
std::optional<ReadoutEquation> VisualTrack::measureReadout(const Draft& draft, const TimedPoses& poses,
                                                           int position, RigSide side) {
  const Eigen::Isometry3d T_left_right = leftFromRight(camera_.baseline);
  const auto view_of = [&](int at) {
    ExposureMotion motion = motionByPolynomial(poses, at, at - track_rows::kReadoutNeighbours,
                                               at + track_rows::kReadoutNeighbours);
    Eigen::Isometry3d T_world_camera = poses[at].T_world_camera;
    if (side == RigSide::right) {
      T_world_camera = T_world_camera * motion.at(poses[at].offset) * T_left_right;
      motion = motionAbout(motion, poses[at].offset, T_left_right, timing_.range());
    }
    return ReadoutView{draft.window[at].index, T_world_camera, motion};
  };
  const ReadoutView before = view_of(position - track_rows::kReadoutNeighbours), now = view_of(position);
  setRowProblem(now.motion, 2.0 * draft.estimates.roughness.variances(poses, position, last_stddev_));
  row_problem_.start = now.motion;
  addReadoutPoints(draft, before, now, side);
  const RowMotion found = row_motion_.estimate(row_problem_);
  return found.converged ? std::optional(found.readout) : std::nullopt;
}

/// Fills the points of the problem of measureReadout().
void VisualTrack::addReadoutPoints(const Draft& draft, const ReadoutView& before, const ReadoutView& now,
                                   RigSide side) {
  std::vector<RowPoint>& points = row_problem_.points;
  points.clear();
  points.reserve(draft.landmarks.capacity());
  const Eigen::Isometry3d T_now_before = now.T_world_camera.inverse() * before.T_world_camera;
  FixedVector<Eigen::Isometry3d, kMaximumWindowPairs> T_before_anchor;
  for (const WindowFrame& frame : draft.window)
    T_before_anchor.push_back(before.T_world_camera.inverse() * frame.T_world_camera);
  const RigCorrection rig = draft.estimates.rig.correction();
  const bool right = side == RigSide::right;
  const auto pixel_of = [&](const Observation& seen) {
    return right ? correctedRight(camera_, rig, seen.right()) : seen.left;
  };
  const auto share_of = [&](const Observation& seen) {
    return right ? timing_.rightShare(seen.right()) : timing_.leftShare(seen.left);
  };
  const auto instant_of = [&](const Observation& seen) {
    return right ? timing_.right(seen.right()) : timing_.left(seen.left);
  };
  for (const Landmark& landmark : draft.landmarks) {
    if (!landmark.hasDepth()) continue;
    const Observation *first = landmark.find(before.index), *last = landmark.find(now.index);
    const std::optional<int> anchor = findFrameIndex(draft.window, landmark.anchor().frame);
    if (!anchor || first == nullptr || last == nullptr) continue;
    if (right && !(first->stereo && last->stereo)) continue;
    const Eigen::Vector3d place =
        T_before_anchor[*anchor].linear() * bearingOf(camera_, landmark.anchor().leftAtExposure()) +
        landmark.inverse_depth * T_before_anchor[*anchor].translation();
    RowPoint point;
    point.inverse_depth = landmark.inverse_depth / std::max(place.z(), kNearestRay);
    point.bearing = bearingOf(camera_, pixelAtExposure(camera_, before.motion, instant_of(*first),
                                                       pixel_of(*first), point.inverse_depth));
    point.pixel = pixel_of(*last);
    point.instant = instant_of(*last);
    point.share = share_of(*last);
    complete(T_now_before, share_of(*first) * before.motion.velocity, landmark, *last, point);
    points.push_back(point);
  }
}

/// Updates the readouts by the images in the middle of the window, where the polynomial through five poses is
/// the best known motion: a readout times a wrong motion would be a wrong readout.
void VisualTrack::updateReadouts(Draft& draft) {
  const TimedPoses poses = timedPoses(draft.window);
  const int position = static_cast<int>(poses.size()) - 1 - track_rows::kReadoutNeighbours;
  if (position < 2 * track_rows::kReadoutNeighbours) return;
  if (!timing_.isRolling()) draft.estimates.roughness.update(poses, last_stddev_);
  ReadoutEstimators& readouts = draft.estimates.readouts;
  const auto update = [&](RigSide side, ReadoutEstimator& readout) {
    if (readout.stddev() == 0.0 && draft.window.back().index % track_rows::kCheckInterval != 0) return;
    if (const auto measured = measureReadout(draft, poses, position, side)) readout.update(*measured);
  };
  update(RigSide::left, readouts.left);
  update(RigSide::right, readouts.right);
  const double before = readouts.left.used();
  if (!readouts.choose()) return;
  timing_.setReadouts(readouts.left.used(), readouts.right.used());
  timeAnew(draft, std::abs(readouts.left.used() - before) < track_rows::kSmallChange * before);
}

/// Computes motions and row shifts of the whole window after a change of a readout. `rows_hold`: what the
/// left rows have told of the motions still holds.
void VisualTrack::timeAnew(Draft& draft, bool rows_hold) {
  const TimedPoses poses = timedPoses(draft.window);
  for (std::size_t i = 0; i < draft.window.size(); ++i) {
    WindowFrame& pair = draft.window[i];
    if (!rows_hold) pair.row_information = {};
    pair.rows.reset();
    pair.motion.reset();
    if (timing_.isRolling()) updateMotion(poses, static_cast<int>(i), last_stddev_, draft);
  }
  for (Landmark& landmark : draft.landmarks)
    for (Observation& observation : landmark.observations)
      observation.left_row_shift = observation.right_row_shift = Eigen::Vector2f::Zero();
  correctRows(camera_, timing_, draft.window, 0, settings_.tracking.predicted_inverse_depth, draft.landmarks);
}

/// Updates the motion about the exposure of the pair at `position` in the window: that of the poses and of
/// the pair's rows, each by its covariance. Rows that show what the cart cannot do between two pairs count
/// for nothing.
void VisualTrack::updateMotion(const TimedPoses& poses, int position, const Vector6d& motion_stddev,
                               Draft& draft) const {
  WindowFrame& pair = draft.window[position];
  const ExposureMotion expected = motionByPoses(poses, position);
  const MotionPrior prior{vectorOf(expected),
                          draft.estimates.roughness.variances(poses, position, motion_stddev),
                          settings_.rolling_shutter.prior_freedom};
  pair.rows.emplace(pair.row_information, prior);
  pair.motion = pair.rows->of(expected);
  const auto by_rows = (pair.motion->velocity - expected.velocity).cwiseAbs();
  const double step = std::abs(parabolaTimes(poses, position).near);
  const double limit = track_rows::kRowsBeyondPoses * settings_.pose_search.maximum_acceleration * step;
  if (step == 0.0 || by_rows.maxCoeff() <= limit) return;
  pair.row_information = {};
  pair.rows.emplace(pair.row_information, prior);
  pair.motion = expected;
}

}  // namespace cartvo::vo
