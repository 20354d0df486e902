#pragma once

#include <Eigen/Core>
#include <optional>

#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"

// Stereo matching of a single point along its epipolar line.

namespace cartvo::vo {

/// Epipolar line of a left pixel in the right image by the disparity d: pixel + at_infinity + (d
/// (per_disparity.x - 1), d per_disparity.y). The default holds if both images were exposed at the same
/// instant; otherwise the right camera has moved on, and the line with it.
struct EpipolarLine {
  Eigen::Vector2d at_infinity = Eigen::Vector2d::Zero();    ///< px
  Eigen::Vector2d per_disparity = Eigen::Vector2d::Zero();  ///< px per px

  Eigen::Vector2d at(const Eigen::Vector2d& pixel, double disparity) const {
    return pixel + at_infinity + disparity * (per_disparity - Eigen::Vector2d::UnitX());
  }
};

/// Result of matchStereo().
struct StereoMatch {
  double disparity = 0.0;                           ///< px, x_left - x_right; along the line
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< px, in the right image
  double correlation = 0.0;                         ///< normalised cross-correlation of left and right patch
};

/// Matches the point at `left` (px, sub-pixel) of the left image in the right image, in the stages of the
/// thesis (4.1-4.4, 4.14): sum of absolute differences in the DoG pyramids, over the whole range at the
/// coarsest level, then +-3 px at each finer one; normalised cross-correlation over +-settings.rows rows;
/// sinusoidal sub-pixel fit. Beyond the thesis, the best few candidates of the coarsest level are refined
/// together: a single one is lost where a near object is in front of a far wall, and the second best shows
/// whether the match is ambiguous. Returns nothing if the correlation is too low, another candidate
/// correlates nearly as well, or the disparity is out of range. `level` of the pyramids is the finest in use,
/// instead of the full image; arguments and result are in px of the full image all the same, except for
/// settings.rows.
std::optional<StereoMatch> matchStereo(const ImagePyramid& left_image, const ImagePyramid& right_image,
                                       const Eigen::Vector2d& left, const StereoSettings& settings,
                                       const EpipolarLine& line = {}, int level = 0);

}  // namespace cartvo::vo
