// Row shifts of observations under rolling shutters.
#include "vo_core/tracking/row_correction.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

/// Motion and depths as one camera of a pair sees them.
struct RowCamera {
  ExposureMotion motion;
  FixedVector<Eigen::Vector4d, kMaximumWindowPairs> depth_of;  ///< by anchor: depth = this . (ray, rho)
};

/// Both cameras of a pair.
struct RowPair {
  RowCamera left, right;
};

RowCamera rowCameraOf(const ExposureMotion& motion, const Eigen::Isometry3d& T_world_camera,
                      const std::vector<WindowFrame>& window) {
  RowCamera camera{motion, {}};
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  for (const WindowFrame& anchor : window) {
    const Eigen::Isometry3d T = T_camera_world * anchor.T_world_camera;
    camera.depth_of.push_back(T.matrix().row(2).transpose());
  }
  return camera;
}

/// Motion of the right camera about its own exposure.
ExposureMotion rightMotionOf(const WindowFrame& frame, double baseline, double range) {
  if (frame.right) return frame.right->motion;
  return motionAbout(frame.motion, frame.offset, leftFromRight(baseline), range);
}

RowPair rowPairOf(const WindowFrame& frame, double baseline, double range,
                  const std::vector<WindowFrame>& window) {
  const Eigen::Isometry3d T_world_right = frame.T_world_camera * rightFromLeft(frame, baseline).inverse();
  return {rowCameraOf(frame.motion, frame.T_world_camera, window),
          rowCameraOf(rightMotionOf(frame, baseline, range), T_world_right, window)};
}

Eigen::Vector2f shiftOf(const StereoCamera& camera, const RowCamera& from, double instant,
                        const Eigen::Vector2d& pixel, const Eigen::Vector4d& place, int anchor) {
  const double depth = std::max(from.depth_of[anchor].dot(place), kNearestRay);
  const Eigen::Vector2d at = pixelAtExposure(camera, from.motion, instant, pixel, place[3] / depth);
  return (pixel - at).cast<float>();
}

}  // namespace

double RowTiming::range() const {
  return std::max(1e-3, 0.5 * std::max(std::abs(shutters_.left.readout), std::abs(shutters_.right.readout)));
}

RowTransform::RowTransform(const StereoCamera& camera, const RowTiming& timing, const WindowFrame& frame,
                           const Eigen::Isometry3d& T_right_left)
    : T_right_left_(T_right_left) {
  if (!timing.isRolling()) return;
  timing_ = &timing;
  left_ = frame.motion;
  right_ = rightMotionOf(frame, camera.baseline, timing.range());
}

Eigen::Isometry3d RowTransform::at(const Eigen::Vector2d& left_pixel) const {
  if (timing_ == nullptr) return T_right_left_;
  return right_.at(timing_->right(left_pixel)).inverse() * T_right_left_ *
         left_.at(timing_->left(left_pixel));
}

Eigen::Isometry3d RowTransform::exposureFromLeft(const Eigen::Vector2d& left_pixel) const {
  if (timing_ == nullptr) return Eigen::Isometry3d::Identity();
  return left_.at(timing_->left(left_pixel));
}

void correctRows(const StereoCamera& camera, const RowTiming& timing, const std::vector<WindowFrame>& window,
                 std::size_t first, double predicted_inverse_depth, std::vector<Landmark>& landmarks) {
  if (!timing.isRolling()) return;
  FixedVector<RowPair, kMaximumWindowPairs> pairs;  // window[first] and later
  for (std::size_t i = first; i < window.size(); ++i)
    pairs.push_back(rowPairOf(window[i], camera.baseline, timing.range(), window));
  for (Landmark& landmark : landmarks) {
    const std::optional<int> anchor = findFrameIndex(window, landmark.anchor().frame);
    if (!anchor) continue;
    Eigen::Vector4d place;
    place << bearingOf(camera, landmark.anchor().leftAtExposure()),
        landmark.hasDepth() ? landmark.inverse_depth : predicted_inverse_depth;
    for (Observation& observation : landmark.observations) {
      if (observation.frame < window[first].index) continue;
      const std::optional<int> at = findFrameIndex(window, observation.frame);
      if (!at) continue;
      const RowPair& pair = pairs[static_cast<std::size_t>(*at) - first];
      observation.left_row_shift =
          shiftOf(camera, pair.left, timing.left(observation.left), observation.left, place, *anchor);
      if (observation.stereo)
        observation.right_row_shift = shiftOf(camera, pair.right, timing.right(observation.right()),
                                              observation.right(), place, *anchor);
    }
  }
}

}  // namespace cartvo::vo
