// Tracking of landmarks: temporal and stereo alignment, change of the anchor, removal and detection.
#include "vo_core/tracking/landmark_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/threads/parallel_loop.hpp"
#include "vo_core/image/affine_alignment.hpp"
#include "vo_core/image/shift_tracking.hpp"
#include "vo_core/tracking/alignment_block.hpp"

namespace cartvo::vo {
namespace {

constexpr int kShiftLevel = 1;  // levels above the patch's own: finest level of the shift

bool isStretched(const Eigen::Matrix2d& warp, double maximum) {
  return (warp - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff() > maximum;
}

/// Pyramid levels of the shift before an alignment in `level`; `tracked` is the number of levels in use. With
/// a predicted pose and a depth, the prediction errs by about 10 px at most and one level suffices; without a
/// depth, one more level reaches all but the nearest landmarks, most of which are lost in any case. Without a
/// prediction to rely on the search starts at the top.
PyramidLevels shiftLevels(int level, bool near_prediction, bool has_depth, int tracked) {
  const int finest = level + kShiftLevel;
  const int top = std::max(finest, tracked - 1);
  if (!near_prediction) return {finest, top};
  return {finest, has_depth ? finest : std::min(finest + 1, top)};
}

/// Whether the landmark was a new corner before this pair; `found` is the outcome of its search.
bool wasNew(const Landmark& landmark, bool found) {
  return landmark.age == (found ? 2 : 1);
}

/// Makes the last observation the anchor, and transforms the depth to it.
void changeAnchor(Landmark& landmark, const StereoCamera& camera, const std::vector<WindowFrame>& window) {
  const WindowFrame* old_anchor = findFrame(window, landmark.anchor().frame);
  const WindowFrame* new_anchor = findFrame(window, landmark.last().frame);
  if (old_anchor != nullptr && new_anchor != nullptr && landmark.hasDepth()) {
    const Eigen::Isometry3d T_new_old = new_anchor->T_world_camera.inverse() * old_anchor->T_world_camera;
    const Eigen::Vector3d bearing = bearingOf(camera, landmark.anchor().leftAtExposure());
    const Projection seen = projectLandmark(camera, T_new_old, bearing, landmark.inverse_depth);
    if (seen.valid) {
      // y = R b + rho t, so rho' = rho / y_z, and d rho' / d rho = (R b)_z / y_z^2.
      const double z = seen.ray.z();
      const double slope = (z - landmark.inverse_depth * T_new_old.translation().z()) / (z * z);
      landmark.inverse_depth /= z;
      landmark.information /= std::max(slope * slope, 1e-6);
    }
  }
  // The stereo match of the new anchor already contributed to the depth: it is not used again.
  Observation last = landmark.last();
  last.stereo = false;
  landmark.observations.clear();
  landmark.observations.push_back(last);
  landmark.warp.setIdentity();
}

}  // namespace

LandmarkTracker::LandmarkTracker(const StereoCamera& camera, const OdometrySettings& settings)
    : camera_(camera),
      settings_(settings),
      detector_(settings.detection, settings.features, cv::Size(camera.width, camera.height)) {
  settings_.stereo.maximum_disparity = nearestDisparity(camera.width);
}

void LandmarkTracker::setTargetFeatureCount(int features) {
  settings_.features = features;
  detector_.setTargetFeatureCount(features);
}

LandmarkTracker::Scene::Scene(const std::vector<WindowFrame>& in, const ImagePyramid& image,
                              std::int64_t index, const std::optional<Eigen::Isometry3d>& T_world_camera)
    : window(in), left(image), frame(index) {
  if (!T_world_camera) return;
  const Eigen::Isometry3d T_camera_world = T_world_camera->inverse();
  const Eigen::Isometry3d T_last_world = window.back().T_world_camera.inverse();
  for (const WindowFrame& seen : window) {
    T_camera_frame.push_back(T_camera_world * seen.T_world_camera);
    T_last_frame.push_back(T_last_world * seen.T_world_camera);
  }
}

/// Predicts the left pixel; returns nothing if it is outside the image by more than the margin.
std::optional<Eigen::Vector2d> LandmarkTracker::expectedPixel(const Landmark& landmark, int anchor,
                                                              const Scene& scene) const {
  Eigen::Vector2d pixel = landmark.last().left;
  if (scene.hasPredictedPose()) {
    const double inverse_depth =
        landmark.hasDepth() ? landmark.inverse_depth : settings_.tracking.predicted_inverse_depth;
    const Projection predicted =
        projectLandmark(camera_, scene.T_camera_frame[static_cast<std::size_t>(anchor)],
                        bearingOf(camera_, landmark.anchor().leftAtExposure()), inverse_depth);
    if (!predicted.valid) return std::nullopt;
    pixel = predicted.pixel + landmark.last().left_row_shift.cast<double>();
  }
  constexpr double kMargin = 0.5 * kPatchSide;  // a patch farther outside shows nothing of the image
  if (pixel.x() < -kMargin || pixel.y() < -kMargin || pixel.x() > camera_.width + kMargin ||
      pixel.y() > camera_.height + kMargin)
    return std::nullopt;
  return pixel;
}

/// Factor by which the landmark's patch grows from its last image to this one, by the predicted pose; 1 if
/// its depth or the pose is not known.
double LandmarkTracker::predictedGrowth(const Landmark& landmark, const Scene& scene) const {
  if (!landmark.hasDepth() || !scene.hasPredictedPose()) return 1.0;
  const std::optional<int> anchor = findFrameIndex(scene.window, landmark.anchor().frame);
  if (!anchor) return 1.0;
  const auto depth_in = [&](const Eigen::Isometry3d& T) {  // times the inverse depth
    return T.linear().row(2).dot(bearingOf(camera_, landmark.anchor().leftAtExposure())) +
           landmark.inverse_depth * T.translation().z();
  };
  const double now = depth_in(scene.T_camera_frame[static_cast<std::size_t>(*anchor)]);
  const double before = depth_in(scene.T_last_frame[static_cast<std::size_t>(*anchor)]);
  return now > 0.0 && before > 0.0 ? before / now : 1.0;
}

std::optional<ShiftTask> LandmarkTracker::startShift(Landmark& landmark, const Scene& scene,
                                                     std::int64_t oldest_anchor) const {
  const WindowFrame* last = findFrame(scene.window, landmark.last().frame);
  if (last == nullptr) return std::nullopt;
  if (landmark.anchor().frame < oldest_anchor ||
      isStretched(landmark.warp, settings_.tracking.maximum_stretch))
    changeAnchor(landmark, camera_, scene.window);
  const std::optional<int> anchor = findFrameIndex(scene.window, landmark.anchor().frame);
  if (!anchor) return std::nullopt;
  const auto expected = expectedPixel(landmark, *anchor, scene);
  if (!expected) return std::nullopt;
  const PyramidLevels levels = shiftLevels(landmark.level, scene.hasPredictedPose() && !scene.wide,
                                           landmark.hasDepth(), settings_.tracking.levels);
  return ShiftTask{last->left.get(), &scene.left, landmark.last().left, *expected, levels};
}

void LandmarkTracker::shiftAll(std::span<Landmark> landmarks, const Scene& scene, std::int64_t oldest_anchor,
                               std::span<TrackingAttempt> attempts) const {
  FixedVector<ShiftTask, AlignmentBlock::kCapacity> tasks;
  FixedVector<std::size_t, AlignmentBlock::kCapacity> of_landmark;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (const auto task = startShift(landmarks[i], scene, oldest_anchor)) {
      attempts[i].expected = task->guess;
      tasks.push_back(*task);
      of_landmark.push_back(i);
    }
  }
  std::array<std::optional<Eigen::Vector2d>, AlignmentBlock::kCapacity> shifted;
  trackShifts({tasks.begin(), tasks.size()}, settings_.tracking.minimum_shift_correlation,
              {shifted.data(), tasks.size()});
  for (std::size_t i = 0; i < tasks.size(); ++i)
    attempts[of_landmark[i]].shifted = shifted[i];
}

void LandmarkTracker::alignWithAnchors(std::span<const Landmark> landmarks, const Scene& scene,
                                       std::span<TrackingAttempt> attempts) const {
  const TrackingSettings& tracking = settings_.tracking;
  AlignmentBlock block;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!attempts[i].shifted || attempts[i].aligned) continue;
    const Landmark& landmark = landmarks[i];
    const WindowFrame* anchor = findFrame(scene.window, landmark.anchor().frame);
    AffineAlignment start;
    start.position = *attempts[i].shifted;
    start.warp = predictedGrowth(landmark, scene) * landmark.warp;
    block.add(i, {*anchor->left, scene.left, landmark.level}, landmark.anchor().left, start);
  }
  block.align(tracking, [&](std::size_t i, const AffineAlignment& aligned) {
    if (aligned.correlation >= tracking.minimum_correlation && isConsistentBackward(aligned, tracking))
      attempts[i].aligned = aligned;
  });
}

/// Aligns what is still missing at the predicted pixels: a patch that has grown much is not found by a shift.
void LandmarkTracker::alignAtPrediction(std::span<const Landmark> landmarks, const Scene& scene,
                                        std::span<TrackingAttempt> attempts) const {
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (attempts[i].aligned) continue;
    const std::optional<int> anchor = findFrameIndex(scene.window, landmarks[i].anchor().frame);
    if (anchor && landmarks[i].hasDepth())
      attempts[i].shifted = expectedPixel(landmarks[i], *anchor, scene);
    else
      attempts[i].shifted.reset();
  }
  alignWithAnchors(landmarks, scene, attempts);
}

void LandmarkTracker::trackBlock(std::span<Landmark> landmarks, const Scene& scene,
                                 std::int64_t oldest_anchor, std::span<SearchResult> results) const {
  std::array<TrackingAttempt, AlignmentBlock::kCapacity> attempts;
  shiftAll(landmarks, scene, oldest_anchor, attempts);
  alignWithAnchors(landmarks, scene, attempts);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    TrackingAttempt& attempt = attempts[i];
    if (!attempt.shifted || attempt.aligned) continue;
    if (landmarks[i].observations.size() > 1)
      changeAnchor(landmarks[i], camera_, scene.window);
    else
      attempt.shifted.reset();
  }
  alignWithAnchors(landmarks, scene, attempts);
  if (scene.at_prediction) alignAtPrediction(landmarks, scene, attempts);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const auto& aligned = attempts[i].aligned;
    results[i] = SearchResult::lost;
    if (!aligned || !scene.left.mask.allows(aligned->position, landmarks[i].level)) continue;
    const bool near =
        (aligned->position - attempts[i].expected).norm() <= settings_.tracking.maximum_prediction_error;
    results[i] = near || !landmarks[i].hasDepth() ? SearchResult::near : SearchResult::far;
    landmarks[i].warp = aligned->warp;
    Observation observation;
    observation.frame = scene.frame;
    observation.left = aligned->position;
    observation.left_row_shift = landmarks[i].last().left_row_shift;  // nearly
    observation.relative_noise = relativeNoise(aligned->variance, landmarks[i].level, settings_.tracking);
    landmarks[i].observations.push_back(observation);
    ++landmarks[i].age;
  }
}

void LandmarkTracker::trackAll(std::vector<Landmark>& landmarks, const Scene& scene,
                               std::int64_t oldest_anchor, std::vector<SearchResult>& results) const {
  results.reserve(landmarks.capacity());
  results.resize(landmarks.size());
  forEachBlock(landmarks.size(), AlignmentBlock::kCapacity, [&](std::size_t first, std::size_t count) {
    trackBlock(std::span(landmarks).subspan(first, count), scene, oldest_anchor,
               std::span(results).subspan(first, count));
  });
}

TrackingOutcome LandmarkTracker::track(const std::vector<Landmark>& previous, std::vector<Landmark>& tracked,
                                       const TrackedImage& image) {
  tracked = previous;
  Scene scene(image.window, image.left, image.frame, image.T_world_camera);
  scene.at_prediction = image.pose_is_found;
  trackAll(tracked, scene, image.oldest_anchor, found_);
  TrackingOutcome outcome{image.T_world_camera, false};
  if (image.T_world_camera && !image.pose_is_found && predictionFails())
    outcome = {searchWidely(previous, tracked, image), true};
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    if (wasNew(tracked[i], isFound(i))) detector_.recordOutcome(tracked[i], isFound(i));
    if (!isFound(i)) continue;
    if (kept != i) tracked[kept] = std::move(tracked[i]);
    ++kept;
  }
  tracked.resize(kept);
  return outcome;
}

/// Whether the landmarks contradict the predicted pose: less than half are found, or most of them far from
/// it.
bool LandmarkTracker::predictionFails() const {
  const auto near = std::count(found_.begin(), found_.end(), SearchResult::near);
  const auto far = std::count(found_.begin(), found_.end(), SearchResult::far);
  return static_cast<double>(near + far) < kMajority * static_cast<double>(found_.size()) || far > near;
}

/// Searches the landmarks that were not found once more, in all pyramid levels, and marks those found in
/// found_. Returns the corrected prediction.
Eigen::Isometry3d LandmarkTracker::searchWidely(const std::vector<Landmark>& previous,
                                                std::vector<Landmark>& tracked, const TrackedImage& image) {
  const Eigen::Isometry3d& expected = *image.T_world_camera;
  Eigen::Isometry3d prediction =
      correctedByImageShift(previous, image.window, image.left, camera_, expected).value_or(expected);
  Scene scene(image.window, image.left, image.frame, prediction);
  scene.wide = scene.at_prediction = true;
  lost_.clear();
  for (std::size_t i = 0; i < previous.size(); ++i)
    if (!isFound(i)) lost_.push_back(previous[i]);
  trackAll(lost_, scene, image.oldest_anchor, found_wide_);
  for (std::size_t i = 0, searched = 0; i < previous.size(); ++i) {
    if (isFound(i)) continue;
    found_[i] = found_wide_[searched];
    tracked[i] = std::move(lost_[searched++]);
  }
  return prediction;
}

void LandmarkTracker::replenish(std::vector<Landmark>& landmarks, const ImagePyramid& left,
                                std::int64_t frame) {
  ReplenishBuffers& now = buffers_;
  now.spacing.reset(camera_.width, camera_.height, minimumDistance(settings_, camera_.width, camera_.height));
  now.reserve(landmarks.capacity());
  now.order.clear();
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    now.order.emplace_back(-landmarks[i].weight * std::min(landmarks[i].age, 10), i);
  std::sort(now.order.begin(), now.order.end());
  now.kept.clear();
  for (const auto& [merit, index] : now.order) {
    const Eigen::Vector2d pixel = landmarks[index].last().left;
    if (!now.spacing.insert(pixel) || now.kept.size() >= static_cast<std::size_t>(settings_.features))
      continue;
    now.kept.push_back(std::move(landmarks[index]));
  }
  landmarks.swap(now.kept);

  for (const LandmarkCorner& corner : detector_.detect(left, landmarks, now.spacing)) {
    Landmark landmark;
    landmark.level = corner.level;
    landmark.age = 1;
    Observation observation;
    observation.frame = frame;
    observation.left = corner.pixel;
    landmark.observations.push_back(observation);
    landmarks.push_back(std::move(landmark));
  }
}

}  // namespace cartvo::vo
