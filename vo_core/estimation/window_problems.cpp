// Conversion of landmarks and poses to pose search and bundle problems.
#include "vo_core/estimation/window_problems.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "vo_core/geometry/image_cells.hpp"
#include "vo_core/geometry/reprojection.hpp"

namespace cartvo::vo {
namespace {

// Prior of a landmark without a depth: weak, so that it does not pull a near one away from the camera.
constexpr double kUnknownInverseDepth = 0.03;  // 1/m
constexpr double kUnknownInformation = 1.0;    // m^2, of a stddev of 1 / m
// m^2, of a stddev of 0.05 / m: a depth from motion that is more certain than this is used.
constexpr double kCertainInformation = 400.0;

/// Bounds the weight of each cell of the image to that of the median cell, so that a lettering or a dirty
/// spot with many corners does not outvote a scene with few.
void boundCellWeights(const StereoCamera& camera, std::vector<PosePoint>& points) {
  std::array<double, kCells> weights{}, occupied;
  for (const PosePoint& point : points)
    weights[cellOf(camera, point.left)] += point.weight;
  const auto end = std::copy_if(weights.begin(), weights.end(), occupied.begin(),
                                [](double weight) { return weight > 0.0; });
  const auto middle = occupied.begin() + (end - occupied.begin()) / 2;
  if (middle == end) return;
  std::nth_element(occupied.begin(), middle, end);
  for (PosePoint& point : points)
    point.weight *= std::min(1.0, *middle / weights[cellOf(camera, point.left)]);
}

}  // namespace

TimedPoses timedPoses(const std::vector<WindowFrame>& window) {
  TimedPoses poses;
  for (const WindowFrame& frame : window)
    poses.push_back({1e-9 * static_cast<double>(frame.exposure_ns - window.front().exposure_ns), frame.offset,
                     frame.T_world_camera, frame.dpose_doffset, frame.rows});
  return poses;
}

void toPosePoints(const std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                  const StereoCamera& camera, std::vector<PosePoint>& points,
                  std::vector<std::size_t>& chosen) {
  points.clear();
  points.reserve(landmarks.capacity());
  chosen.clear();
  chosen.reserve(landmarks.capacity());
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& landmark = landmarks[i];
    if (!landmark.hasDepth()) continue;
    const std::optional<int> anchor = findFrameIndex(window, landmark.anchor().frame);
    if (!anchor) continue;
    PosePoint point;
    point.anchor = *anchor;
    point.bearing = bearingOf(camera, landmark.anchor().leftAtExposure());
    point.inverse_depth = landmark.inverse_depth;
    point.inverse_depth_stddev = 1.0 / std::sqrt(landmark.information);
    point.left = landmark.last().leftAtExposure();
    point.weight = landmark.weight;
    point.still = landmark.lastFlow() < kStillFlow;
    point.level = landmark.level;
    points.push_back(point);
    chosen.push_back(i);
  }
  boundCellWeights(camera, points);
}

void toRightCameraPoints(const std::vector<Landmark>& landmarks, const std::vector<std::size_t>& chosen,
                         const StereoCamera& camera, const RigCorrection& rig,
                         std::vector<PosePoint>& points) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Observation& last = landmarks[chosen[i]].last();
    if (!last.stereo) continue;
    points[seen] = points[i];
    points[seen++].left = correctedRight(camera, rig, last.rightAtExposure());
  }
  points.resize(seen);
}

void toBundleLandmarks(const std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                       const StereoCamera& camera, const RigCorrection& rig,
                       std::vector<BundleLandmark>& items, std::vector<std::size_t>& chosen) {
  chosen.clear();
  chosen.reserve(landmarks.capacity());
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    if (landmarks[i].observations.size() > 1) chosen.push_back(i);
  items.reserve(landmarks.capacity());
  items.resize(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Landmark& landmark = landmarks[chosen[i]];
    BundleLandmark& item = items[i] = {};
    item.bearing = bearingOf(camera, landmark.anchor().leftAtExposure());
    item.weight = landmark.poseWeight();
    item.level = landmark.level;
    item.inverse_depth = landmark.inverse_depth;
    item.prior_inverse_depth = landmark.prior_inverse_depth;
    item.prior_information = landmark.prior_information;
    item.prior_dinverse_depth_doffset = landmark.prior_dinverse_depth_doffset;
    if (!landmark.hasDepth()) {
      item.inverse_depth = item.prior_inverse_depth = kUnknownInverseDepth;
      item.prior_information = kFollowerWeight * kUnknownInformation;
      item.prior_dinverse_depth_doffset = 0.0;
    }
    for (const Observation& observation : landmark.observations)
      if (const std::optional<int> pose = findFrameIndex(window, observation.frame))
        item.observations.push_back({*pose, observation.stereo, observation.leftAtExposure(),
                                     correctedRight(camera, rig, observation.rightAtExposure()),
                                     observation.relative_noise});
  }
}

void updateDepth(const BundleLandmark& adjusted, Landmark& landmark) {
  const double information =
      landmark.hasDepth() ? adjusted.information : adjusted.information / kFollowerWeight;
  if (!landmark.hasDepth() && information < kCertainInformation) return;
  landmark.inverse_depth = adjusted.inverse_depth;
  landmark.information = information;
  landmark.dinverse_depth_doffset = adjusted.dinverse_depth_doffset;
}

}  // namespace cartvo::vo
