#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vo_core/stereo_camera.hpp"
#include "vo_core/tracking/landmark.hpp"
#include "vo_core/tracking/window_frame.hpp"

// Correction of a predicted pose by the images as a whole.

namespace cartvo::vo {

/// Result of the search for a landmark near a predicted pose.
enum class SearchResult : std::uint8_t {
  lost,
  near,  ///< found near the predicted pixel, or without a depth
  far,   ///< found farther from it
};

/// The predicted pose, rotated so that it agrees with the shift of the image as a whole since the window's
/// last pair. Returns nothing if the images show no shift, or if it is the one predicted, to a pixel of the
/// coarsest level. `landmarks`: as of the window's last pair.
std::optional<Eigen::Isometry3d> correctedByImageShift(std::span<const Landmark> landmarks,
                                                       const std::vector<WindowFrame>& window,
                                                       const ImagePyramid& left, const StereoCamera& camera,
                                                       const Eigen::Isometry3d& T_world_camera);

}  // namespace cartvo::vo
