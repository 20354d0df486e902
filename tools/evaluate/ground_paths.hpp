#pragma once

#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "tools/evaluate/association.hpp"

namespace cartvo {

/// Axes of the ground plane in a plot from above.
enum class TopView : std::uint8_t {
  camera_axes,  ///< x right, z forward, as in KITTI
  body_axes,    ///< x forward, y left
};

/// The true path and the placed estimates on the ground plane, m, and the names of the axes.
struct GroundPaths {
  std::vector<cv::Point2d> truth;
  std::vector<std::vector<cv::Point2d>> estimates;
  std::string horizontal, vertical;
};

/// Forward is up, unless the path is longer forward than sideways: then forward is to the right. Of several
/// estimates the truth is that part of it that most poses have.
GroundPaths groundPaths(const std::vector<const AssociatedTrajectories*>& associated, TopView view);

}  // namespace cartvo
