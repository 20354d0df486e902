// Conversion of landmarks to problems of the pose search.
#include "vo_core/estimation/pose_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "vo_core/geometry/image_cells.hpp"
#include "vo_core/geometry/reprojection.hpp"

namespace cartvo::vo {
namespace {

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

}  // namespace cartvo::vo
