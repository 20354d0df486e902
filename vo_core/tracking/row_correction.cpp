// Row shifts of observations under rolling shutters.
#include "vo_core/tracking/row_correction.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

constexpr double kUnknownInverseDepth = 0.02;  // 1/m, of landmarks without a depth

/// Motion and depths as one camera of a pair sees them.
struct RowCamera {
  ExposureMotion motion;
  FixedVector<Eigen::Vector4d, kMaximumWindowPairs> depth_of;  ///< by anchor: depth = this . (ray, rho)
};

/// Both cameras of a pair.
struct RowPair {
  bool moves = false;
  RowCamera left, right;
};

Eigen::Isometry3d rightFromLeftAt(const ExposureMotion& motion, double offset, double baseline) {
  return (motion.at(offset) * Eigen::Translation3d(baseline, 0.0, 0.0)).inverse();
}

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
  return motionAbout(*frame.motion, frame.offset, Eigen::Isometry3d(Eigen::Translation3d(baseline, 0.0, 0.0)),
                     range);
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
  if (!timing.isRolling() || !frame.motion) return;
  timing_ = &timing;
  left_ = *frame.motion;
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
                 std::size_t first, std::vector<Landmark>& landmarks) {
  if (!timing.isRolling()) return;
  FixedVector<RowPair, kMaximumWindowPairs> pairs;
  for (const WindowFrame& frame : window) {
    RowPair pair;
    pair.moves = frame.motion.has_value();
    if (pair.moves) {
      const Eigen::Isometry3d T_left_right =
          rightFromLeftAt(*frame.motion, frame.offset, camera.baseline).inverse();
      pair.left = rowCameraOf(*frame.motion, frame.T_world_camera, window);
      pair.right = rowCameraOf(rightMotionOf(frame, camera.baseline, timing.range()),
                               frame.T_world_camera * T_left_right, window);
    }
    pairs.push_back(pair);
  }
  const std::int64_t oldest = window.front().index;
  std::array<int, 64> position{};  // by index of the pair, relative to the oldest
  position.fill(-1);
  for (std::size_t i = 0; i < window.size(); ++i)
    if (const std::int64_t at = window[i].index - oldest; at < static_cast<std::int64_t>(position.size()))
      position[at] = static_cast<int>(i);
  const auto find = [&](std::int64_t index) {
    const std::int64_t at = index - oldest;
    return at >= 0 && at < static_cast<std::int64_t>(position.size()) ? position[at] : -1;
  };
  for (Landmark& landmark : landmarks) {
    const int anchor = find(landmark.anchor().frame);
    if (anchor < 0) continue;
    Eigen::Vector4d place;
    place << bearingOf(camera, landmark.anchor().leftAtExposure()),
        landmark.hasDepth() ? landmark.inverse_depth : kUnknownInverseDepth;
    for (Observation& observation : landmark.observations) {
      const int at = find(observation.frame);
      if (at < static_cast<int>(first) || !pairs[at].moves) continue;
      const RowPair& pair = pairs[at];
      observation.left_row_shift =
          shiftOf(camera, pair.left, timing.left(observation.left), observation.left, place, anchor);
      if (observation.stereo)
        observation.right_row_shift = shiftOf(camera, pair.right, timing.right(observation.right()),
                                              observation.right(), place, anchor);
    }
  }
}

}  // namespace cartvo::vo
