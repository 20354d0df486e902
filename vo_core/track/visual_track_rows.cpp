// Rolling shutters in a track: the motion about exposures and the row shifts that follow from it.
#include <algorithm>
#include <cmath>

#include "vo_core/estimation/window_problems.hpp"
#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {
namespace {

// Pairs of a window from which rows are used: the depths of the first pair are those of an unknown motion
// between its exposures.
constexpr std::size_t kFirstWindow = 5;
constexpr int kRightReadoutInterval = 4;  // pairs from one estimate of the right readout to the next

constexpr double kLongestExtrapolation = 0.1;  // s, over which an acceleration is taken to last

/// Change of a point's ray by a step of its anchor. Bearing and inverse depth remain those at z = 1.
Eigen::Vector3d rayByAnchorMotion(const Eigen::Isometry3d& T_camera_anchor, const Vector6d& step,
                                  const RowPoint& point) {
  const Eigen::Vector3d moved = step.tail<3>().cross(point.bearing) + point.inverse_depth * step.head<3>();
  return T_camera_anchor.linear() * (moved - moved.z() * point.bearing) -
         moved.z() * point.inverse_depth * T_camera_anchor.translation();
}

}  // namespace

/// Extrapolates the motion about the last exposure to that of the pair.
void VisualTrack::expectMotion(const PreparedPair& pair, Draft& draft) const {
  const ExposureMotion& last = *window_.back().motion;
  const double step = std::min(secondsSinceLast(pair), kLongestExtrapolation);
  WindowFrame& newest = draft.window.back();
  newest.motion = ExposureMotion{last.velocity + step * last.acceleration, last.acceleration};
  newest.rows = MotionBlend();
  newest.rows->expected_share.setZero();
  newest.rows->by_rows << newest.motion->velocity, newest.motion->acceleration;
}

/// Computes the row shifts of the newest pair's observations for the left camera at `T_world_camera`.
void VisualTrack::correctNewestRows(Draft& draft, const Eigen::Isometry3d& T_world_camera) {
  if (!timing_.isRolling()) return;
  draft.window.back().T_world_camera = T_world_camera;
  correctRows(camera_, timing_, draft.window, draft.window.size() - 1, draft.landmarks);
}

/// Adds the uncertainty of the expected motion to the noise of the points of the pose search.
void VisualTrack::addRowNoise(const PreparedPair& pair, const Draft& draft) {
  const RowInformation::Vector variances = roughness_.variancesAfter(secondsSinceLast(pair));
  const double translation = variances.head<3>().mean(), rotation = variances.segment<3>(3).mean();
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    PosePoint& point = pose_problem_.points[i];
    const double instant = timing_.left(draft.landmarks[chosen_[i]].last().left);
    point.row_noise = camera_.focal_length * std::abs(instant) *
                      std::sqrt(rotation + point.inverse_depth * point.inverse_depth * translation);
  }
}

/// Builds the problem of the newest left image.
void VisualTrack::buildRowProblem(const Draft& draft) {
  RowMotionProblem& problem = row_problem_;
  const TimedPoses poses = timedPoses(draft.window);
  const int newest = static_cast<int>(poses.size()) - 1;
  problem.camera = camera_;
  problem.noise = noise_;
  problem.robust_width = settings_.bundle.robust_width;
  problem.expected = motionByPoses(poses, newest);
  problem.variances = roughness_.variances(poses, newest, last_stddev_);
  problem.start = *draft.window.back().motion;
  problem.readout_stddev = readouts_.leftStddev();
  addRowPoints(draft, draft.window.back().T_world_camera, true,
               [&](const Observation& last, RowPoint& point) {
                 point.pixel = last.left;
                 point.instant = timing_.left(last.left);
                 point.share = timing_.leftShare(last.left);
                 return true;
               });
}

/// Fills the points of the problem for a camera of the newest pair at `T_world_camera`. `observe` sets pixel,
/// instant and share, or returns false for a landmark that the camera does not see. `by_anchors`: whether the
/// camera is the left one, whose readout timed the anchors, too: a steady turn shears all its images alike,
/// so that only points whose rows change tell the readout.
template <typename Observe>
void VisualTrack::addRowPoints(const Draft& draft, const Eigen::Isometry3d& T_world_camera, bool by_anchors,
                               const Observe& observe) {
  std::vector<RowPoint>& points = row_problem_.points;
  points.clear();
  points.reserve(draft.landmarks.capacity());
  FixedVector<Eigen::Isometry3d, kMaximumWindowPairs> T_camera_anchor;
  for (const WindowFrame& frame : draft.window)
    T_camera_anchor.push_back(T_world_camera.inverse() * frame.T_world_camera);
  for (const Landmark& landmark : draft.landmarks) {
    if (!landmark.hasDepth() || landmark.observations.size() < 2) continue;
    const std::optional<int> anchor = findFrameIndex(draft.window, landmark.anchor().frame);
    RowPoint point;
    if (!anchor || !observe(landmark.last(), point)) continue;
    const Eigen::Isometry3d& T = T_camera_anchor[*anchor];
    point.bearing = bearingOf(camera_, landmark.anchor().leftAtExposure());
    point.ray = T.linear() * point.bearing + landmark.inverse_depth * T.translation();
    point.ray_by_inverse_depth = T.translation();
    point.inverse_depth = landmark.inverse_depth;
    if (by_anchors) {
      const Vector6d& velocity = draft.window[*anchor].motion->velocity;
      const Vector6d moved = timing_.leftShare(landmark.anchor().left) * velocity;
      point.ray_by_readout = rayByAnchorMotion(T, moved, point);
    }
    point.inverse_depth_information = landmark.information;
    point.relative_noise = landmark.last().relative_noise;
    point.weight = landmark.trust;
    point.level = landmark.level;
    points.push_back(point);
  }
}

/// Estimates the newest pair's pose and motion from the rows of its left image, and from them all row shifts
/// of the window.
void VisualTrack::estimateRowMotion(Draft& draft, TrackedMotion& motion) {
  buildRowProblem(draft);
  const RowMotion found = row_motion_.estimate(row_problem_);
  const bool use = found.converged && draft.window.size() >= kFirstWindow;
  if (use) useRowMotion(found, draft, motion);
  const TimedPoses poses = timedPoses(draft.window);
  updateMotions(poses, draft.window);
  if (use) {
    const WindowFrame& newest = draft.window.back();
    const Matrix6d covariance = newest.rows->covariance.topLeftCorner<6, 6>();
    motion.twist = ExposureTwist{newest.motion->velocity, covariance};
    roughness_.update(poses, newest.rows->excess.head<6>());
  }
  if (use && draft.window.back().index % kRightReadoutInterval == 0) estimateRightReadout(draft);
  timing_.setReadouts(readouts_.left(), readouts_.right());
  correctRows(camera_, timing_, draft.window, 0, draft.landmarks);
}

void VisualTrack::useRowMotion(const RowMotion& found, Draft& draft, TrackedMotion& motion) {
  WindowFrame& newest = draft.window.back();
  newest.T_world_camera = orthonormalised(newest.T_world_camera * motionFromVector(found.pose_change));
  // The landmarks' bearings were moved by the motions about earlier exposures, whose errors are alike.
  const WindowFrame& before = draft.window[draft.window.size() - 2];
  newest.row_information = before.rows ? withMapError(found.rows, before.rows->covariance) : found.rows;
  motion.covariance_by_rows = found.pose_covariance_by_motion;
  readouts_.updateLeft(found.readout, 1.0);
}

/// Updates the right camera's readout by the rows of its image, with the motion that is known.
void VisualTrack::estimateRightReadout(const Draft& draft) {
  const WindowFrame& newest = draft.window.back();
  const Eigen::Isometry3d T_left_right = leftFromRight(camera_.baseline);
  RowMotionProblem& problem = row_problem_;
  problem.expected = problem.start =
      motionAbout(*newest.motion, newest.offset, T_left_right, timing_.range());
  problem.readout_stddev = readouts_.rightStddev();
  const RigCorrection rig = rig_.correction();
  addRowPoints(draft, newest.T_world_camera * newest.motion->at(newest.offset) * T_left_right, false,
               [&](const Observation& last, RowPoint& point) {
                 if (!last.stereo) return false;
                 point.pixel = correctedRight(camera_, rig, last.right());
                 point.instant = timing_.right(last.right());
                 point.share = timing_.rightShare(last.right());
                 return true;
               });
  if (const RowMotion found = row_motion_.estimate(problem); found.converged)
    readouts_.updateRight(found.readout, kRightReadoutInterval);
}

/// Motions about all exposures of the window, from its poses and from the rows.
void VisualTrack::updateMotions(const TimedPoses& poses, std::vector<WindowFrame>& window) const {
  for (int i = 0; i < static_cast<int>(window.size()); ++i) {
    const ExposureMotion expected = motionByPoses(poses, i);
    window[i].rows.emplace(window[i].row_information, expected, roughness_.variances(poses, i, last_stddev_));
    window[i].motion = window[i].rows->of(expected);
  }
}

}  // namespace cartvo::vo
