#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {

/// The right camera at its own exposure.
struct RightExposure {
  Eigen::Isometry3d T_left_right;  ///< to the axes of the left camera at the left exposure
  ExposureMotion motion;           ///< of the right camera, about its exposure
};

/// A pair in the window: the data that remain after its processing.
struct WindowFrame {
  std::int64_t index = -1;
  std::int64_t exposure_ns = 0;  ///< ns, exposure of the left image
  double offset = 0.0;           ///< s, right exposure minus left exposure
  SharedPyramid left;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  Matrix6d pose_covariance = Matrix6d::Zero();  ///< relative to the track's first pair
  ExposureMotion motion;                        ///< about the left exposure
  std::optional<RightExposure> right;           ///< by the trajectory; empty before the window is adjusted
};

/// Transform of points from a pair's left camera to its right one, each at its own exposure.
inline Eigen::Isometry3d rightFromLeft(const WindowFrame& frame, double baseline) {
  if (frame.right) return frame.right->T_left_right.inverse();
  return (frame.motion.at(frame.offset) * leftFromRight(baseline)).inverse();
}

/// Time from the left exposure of one pair to that of another, s.
inline double secondsBetween(const WindowFrame& from, const WindowFrame& to) {
  return 1e-9 * static_cast<double>(to.exposure_ns - from.exposure_ns);
}

/// Finds the position in the window of the pair with this index; nothing if the pair is not in the window.
inline std::optional<int> findFrameIndex(const std::vector<WindowFrame>& window, std::int64_t index) {
  for (std::size_t i = 0; i < window.size(); ++i)
    if (window[i].index == index) return static_cast<int>(i);
  return std::nullopt;
}

/// Finds the pair with this index, or returns nullptr.
inline const WindowFrame* findFrame(const std::vector<WindowFrame>& window, std::int64_t index) {
  const std::optional<int> found = findFrameIndex(window, index);
  return found ? &window[static_cast<std::size_t>(*found)] : nullptr;
}

}  // namespace cartvo::vo
