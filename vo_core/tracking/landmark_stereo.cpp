// Matching of landmarks in the right image.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/threads/parallel_loop.hpp"
#include "vo_core/image/affine_alignment.hpp"
#include "vo_core/stereo/stereo_matcher.hpp"
#include "vo_core/tracking/alignment_block.hpp"
#include "vo_core/tracking/landmark_tracker.hpp"

namespace cartvo::vo {
namespace {

/// Epipolar line in the right image, to first order in the inverse depth.
EpipolarLine epipolarLine(const StereoCamera& camera, const Eigen::Isometry3d& T_right_left,
                          const Eigen::Vector2d& pixel) {
  EpipolarLine line;
  const Eigen::Vector3d bearing = bearingOf(camera, pixel);
  const Projection infinity = projectLandmark(camera, T_right_left, bearing, 0.0);
  if (!infinity.valid) return line;
  line.at_infinity = infinity.pixel - pixel;
  const ProjectionJacobians by = projectionJacobians(camera, T_right_left, 0.0, infinity);
  line.per_disparity =
      by.by_inverse_depth / (camera.focal_length * camera.baseline) + Eigen::Vector2d::UnitX();
  return line;
}

}  // namespace

/// Initial value of the alignment in the right image: predicted from the depth or, without one, found by a
/// search along the epipolar line.
std::optional<AffineAlignment> LandmarkTracker::startInRight(const Landmark& landmark, const StereoView& view,
                                                             double inverse_depth) const {
  const Eigen::Vector2d& left = landmark.last().left;
  const Eigen::Isometry3d T_right_left = view.right_from_left.at(left);
  AffineAlignment start;
  if (inverse_depth > 0.0) {
    const Projection expected =
        projectLandmark(camera_, T_right_left, bearingOf(camera_, left), inverse_depth);
    if (!expected.valid) return std::nullopt;
    start.position = expected.pixel;
    start.warp = landmark.stereo_warp;
  } else {
    const EpipolarLine line = epipolarLine(camera_, T_right_left, left);
    const auto found =
        cartvo::vo::matchStereo(view.left, view.right, left, settings_.stereo, line, landmark.level);
    if (!found) return std::nullopt;
    start.position = found->right;
  }
  if (!view.right.grey.front().contains(start.position)) return std::nullopt;
  return start;
}

/// Predicted inverse depth in the newest left camera; 0 for landmarks without a depth or with an anchor
/// outside the window.
double LandmarkTracker::expectedInverseDepth(const Landmark& landmark, const Scene& scene) const {
  const std::optional<int> anchor = findFrameIndex(scene.window, landmark.anchor().frame);
  if (!landmark.hasDepth() || !anchor) return 0.0;
  const Projection seen =
      projectLandmark(camera_, scene.T_camera_frame[static_cast<std::size_t>(*anchor)],
                      bearingOf(camera_, landmark.anchor().leftAtExposure()), landmark.inverse_depth);
  return seen.valid ? std::max(landmark.inverse_depth, 1e-4) / seen.ray.z() : 0.0;
}

void LandmarkTracker::matchBlock(std::span<Landmark> landmarks, const Scene& scene,
                                 const StereoView& view) const {
  std::array<double, AlignmentBlock::kCapacity> expected_row{};
  AlignmentBlock block;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& landmark = landmarks[i];
    const auto start = startInRight(landmark, view, expectedInverseDepth(landmark, scene));
    if (!start) continue;
    expected_row[i] = start->position.y();
    block.add(i, {view.left, view.right, landmark.level}, landmark.last().left, *start);
  }
  block.align(settings_.tracking, [&](std::size_t i, const AffineAlignment& aligned) {
    Landmark& landmark = landmarks[i];
    if (aligned.correlation < settings_.stereo.minimum_correlation ||
        std::abs(aligned.position.y() - expected_row[i]) >
            (settings_.stereo.rows + 0.5) * levelScale(landmark.level) ||
        !isConsistentBackward(aligned, settings_.tracking) ||
        !view.right.mask.allows(aligned.position, landmark.level))
      return;
    Observation& observation = landmark.observations.back();
    landmark.stereo_warp = aligned.warp;
    observation.stereo = true;
    observation.stereo_offset = observation.left - aligned.position;
  });
}

void LandmarkTracker::matchStereo(std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                                  const ImagePyramid& left, const ImagePyramid& right,
                                  const RowTransform& right_from_left,
                                  const Eigen::Isometry3d& T_world_camera) const {
  const Scene scene(window, left, window.back().index, T_world_camera);
  const StereoView view{left, right, right_from_left};
  forEachBlock(landmarks.size(), AlignmentBlock::kCapacity, [&](std::size_t first, std::size_t count) {
    matchBlock(std::span(landmarks).subspan(first, count), scene, view);
  });
}

}  // namespace cartvo::vo
