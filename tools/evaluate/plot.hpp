#pragma once

#include "tools/evaluate/association.hpp"
#include "tools/report/drawing.hpp"

namespace cartvo {

/// Axes of the ground plane in a plot from above.
enum class TopView : std::uint8_t {
  camera_axes,  ///< x right, z forward, as in KITTI
  body_axes,    ///< x forward, y left
};

/// Plots both paths from above with coinciding starts, and the position error over the distance driven.
Drawing plotTrajectories(const AssociatedTrajectories& associated, TopView view);

}  // namespace cartvo
