#pragma once

#include <opencv2/core/mat.hpp>

#include "tools/evaluate/association.hpp"

namespace cartvo {

/// The plane that a plot looks down on.
enum class TopView : std::uint8_t {
  camera_axes,  ///< x right, z forward: KITTI's
  body_axes,    ///< x forward, y left
};

/// A picture (CV_8UC3) of both paths from above, starts laid together, and of the distance between them over
/// the distance driven.
cv::Mat plotTrajectories(const AssociatedTrajectories& associated, TopView view);

}  // namespace cartvo
