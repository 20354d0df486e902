#pragma once

#include <Eigen/Core>
#include <optional>

#include "vo_core/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

struct StereoMatch {
  double disparity = 0.0;    ///< px, x_left - x_right
  int row_offset = 0;        ///< px, y_right - y_left
  double correlation = 0.0;  ///< normalised, of left and right patch
};

/// Finds the point at `left` (px, sub-pixel) of the left image in the right image, in the stages of the
/// thesis (4.1-4.4, 4.14): sum of absolute differences in the DoG pyramids, the whole range at the coarsest
/// level, then +-3 px at each finer one; normalised cross-correlation over +-settings.rows rows; sinusoidal
/// sub-pixel fit. Beyond the thesis, the best few candidates of the coarsest level go down together: a lone
/// one is lost where a near object stands before a far wall, and the runner-up tells whether the match is
/// ambiguous. No match: correlates too little, a rival correlates nearly as well, or outside the range of
/// disparity.
std::optional<StereoMatch> matchStereo(const ImagePyramid& left_image, const ImagePyramid& right_image,
                                       const Eigen::Vector2d& left, const StereoSettings& settings);

}  // namespace cartvo
