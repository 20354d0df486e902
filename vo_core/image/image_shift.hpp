#pragma once

#include <Eigen/Core>
#include <optional>

#include "vo_core/image/image_pyramid.hpp"

// Shift between two images as a whole.

namespace cartvo::vo {

/// Finds the shift (px of the full image) from `before` to `after` with the highest normalised
/// cross-correlation of their overlap: an exhaustive search over a third of the width and height in a
/// thumbnail of about 100 px, accurate to a pixel of it. The camera's yaw and pitch dominate it. Returns
/// nothing if the images do not correlate.
std::optional<Eigen::Vector2d> findImageShift(const ImagePyramid& before, const ImagePyramid& after);

}  // namespace cartvo::vo
