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

/// Both paths on the ground plane with coinciding starts, m, and the names of the axes.
struct GroundPaths {
  std::vector<cv::Point2d> truth, estimate;
  std::string horizontal, vertical;
};

/// Forward is up, unless the path is longer forward than sideways: then forward is to the right.
GroundPaths groundPaths(const AssociatedTrajectories& associated, TopView view);

}  // namespace cartvo
