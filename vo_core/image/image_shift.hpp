#pragma once

#include <Eigen/Core>
#include <optional>

#include "vo_core/image/image_pyramid.hpp"

// Shift between two images as a whole.

namespace cartvo::vo {

/// Finds the shift (px of the full image) from `before` to `after` with the highest normalised
/// cross-correlation of their overlap in the coarsest common grey level: an exhaustive search over a third of
/// the width and height, at most kMaximumImageShift px of that level, in the half of it, refined in it and by
/// a parabola. The camera's yaw and pitch dominate it. Returns nothing if the level is wider than
/// kMaximumShiftWidth px, which would take long, or if the images do not correlate.
std::optional<Eigen::Vector2d> findImageShift(const ImagePyramid& before, const ImagePyramid& after);

constexpr int kMaximumImageShift = 16;   ///< px of the level, in each direction
constexpr int kMaximumShiftWidth = 320;  ///< px of the level

}  // namespace cartvo::vo
