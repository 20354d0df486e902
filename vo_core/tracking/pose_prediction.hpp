#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vo_core/stereo_camera.hpp"
#include "vo_core/tracking/landmark.hpp"
#include "vo_core/tracking/window_frame.hpp"

// How well a predicted pose agrees with the images, and its correction by the images as a whole.

namespace cartvo::vo {

/// Result of the search for a landmark near a predicted pose.
enum class SearchResult : std::uint8_t {
  lost,
  near,  ///< found near the predicted pixel, or without a depth
  far,   ///< found farther from it
};

/// Median over the landmarks with a depth of the pixels by which a prediction differs from what is given;
/// nothing if there are none.
struct PixelDifference {
  Eigen::Vector2d median = Eigen::Vector2d::Zero();  ///< px, of each coordinate
  double size = 0.0;                                 ///< px, median of the lengths
  std::size_t landmarks = 0;                         ///< number
};

/// Differences of the landmarks' last positions from those predicted at the pose `T_world_camera`. `used`:
/// result for each landmark, of which those found are used; all are used if it is empty.
std::optional<PixelDifference> differenceFromPrediction(std::span<const Landmark> landmarks,
                                                        std::span<const SearchResult> used,
                                                        const std::vector<WindowFrame>& window,
                                                        const StereoCamera& camera,
                                                        const Eigen::Isometry3d& T_world_camera);

/// The predicted pose, rotated so that it agrees with the landmarks found, in the median. Returns nothing
/// if they are few or do not agree.
std::optional<Eigen::Isometry3d> correctedByLandmarks(std::span<const Landmark> landmarks,
                                                      std::span<const SearchResult> used,
                                                      const std::vector<WindowFrame>& window,
                                                      const StereoCamera& camera,
                                                      const Eigen::Isometry3d& T_world_camera,
                                                      const OdometrySettings& settings);

/// The predicted pose, rotated so that it agrees with the shift of the image as a whole since the window's
/// last pair. Returns nothing if the images show no shift, or if it is the one predicted, to a pixel of the
/// coarsest level. `landmarks`: as of the window's last pair.
std::optional<Eigen::Isometry3d> correctedByImageShift(std::span<const Landmark> landmarks,
                                                       const std::vector<WindowFrame>& window,
                                                       const ImagePyramid& left, const StereoCamera& camera,
                                                       const Eigen::Isometry3d& T_world_camera);

}  // namespace cartvo::vo
