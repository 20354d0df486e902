// Conversion of landmarks and poses to pose search and bundle problems.
#include "vo_core/estimation/window_problems.hpp"

#include <cmath>
#include <optional>

#include "vo_core/geometry/triangulation.hpp"

namespace cartvo::vo {
namespace {

// Prior of a landmark without a stereo match.
constexpr double kMonocularInverseDepth = 0.03;  // 1/m
constexpr double kMonocularStddev = 0.1;         // 1/m
constexpr double kMonocularInformation = 1.0 / (kMonocularStddev * kMonocularStddev);

}  // namespace

TimedPoses timedPoses(const std::vector<WindowFrame>& window) {
  TimedPoses poses;
  for (const WindowFrame& frame : window)
    poses.push_back({1e-9 * static_cast<double>(frame.exposure_ns - window.front().exposure_ns), frame.offset,
                     frame.T_world_camera, frame.dpose_doffset});
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
    point.bearing = bearingOf(camera, landmark.anchor().left);
    point.inverse_depth = landmark.inverse_depth;
    point.inverse_depth_stddev = 1.0 / std::sqrt(landmark.information);
    point.left = landmark.last().left;
    point.weight = landmark.trust;
    point.level = landmark.level;
    points.push_back(point);
    chosen.push_back(i);
  }
}

void toRightCameraPoints(const std::vector<Landmark>& landmarks, const std::vector<std::size_t>& chosen,
                         const StereoCamera& camera, const RigCorrection& rig,
                         std::vector<PosePoint>& points) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Observation& last = landmarks[chosen[i]].last();
    if (!last.stereo) continue;
    points[seen] = points[i];
    points[seen++].left = correctedRight(camera, rig, last.left - last.stereo_offset);
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
    item.bearing = bearingOf(camera, landmark.anchor().left);
    item.weight = landmark.trust;
    item.level = landmark.level;
    item.inverse_depth = landmark.inverse_depth;
    item.prior_inverse_depth = landmark.prior_inverse_depth;
    item.prior_information = landmark.prior_information;
    item.prior_dinverse_depth_doffset = landmark.prior_dinverse_depth_doffset;
    if (!landmark.hasDepth()) {
      item.inverse_depth = item.prior_inverse_depth = kMonocularInverseDepth;
      item.prior_information = kMonocularInformation;
      item.prior_dinverse_depth_doffset = 0.0;
    }
    for (const Observation& observation : landmark.observations)
      if (const std::optional<int> pose = findFrameIndex(window, observation.frame))
        item.observations.push_back(
            {*pose, observation.stereo, observation.left,
             correctedRight(camera, rig, observation.left - observation.stereo_offset),
             observation.relative_noise});
  }
}

BundleProblem buildNewestPairProblem(const std::vector<Landmark>& landmarks,
                                     const std::vector<WindowFrame>& window, const StereoCamera& camera) {
  BundleProblem problem;
  problem.camera = camera;
  problem.poses = timedPoses(window);
  const int newest = static_cast<int>(problem.poses.size()) - 1;
  const Eigen::Isometry3d T_right_left = newestRightFromLeft(problem.poses, camera.baseline);
  for (const Landmark& landmark : landmarks) {
    const Observation& last = landmark.last();
    if (!last.stereo) continue;
    const Eigen::Vector2d seen = last.left - last.stereo_offset;
    const auto found = triangulate(camera, T_right_left, last.left, seen);
    if (!found) continue;
    BundleLandmark& item = problem.landmarks.emplace_back();
    item.bearing = bearingOf(camera, last.left);
    item.inverse_depth = found->inverse_depth;
    item.weight = landmark.trust;
    item.level = landmark.level;
    item.observations.push_back({newest, true, last.left, seen, last.relative_noise});
  }
  return problem;
}

bool depthIsObserved(const BundleLandmark& adjusted) {
  return adjusted.information >= 4.0 * kMonocularInformation;
}

}  // namespace cartvo::vo
