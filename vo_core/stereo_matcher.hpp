#pragma once

#include <Eigen/Core>
#include <optional>

#include "vo_core/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// Where the right image shows the points of one left pixel, by their disparity d: at pixel + at_infinity +
/// (d (per_disparity.x - 1), d per_disparity.y). As it is when both images are of one instant; else the right
/// camera has moved on, and the line with it.
struct EpipolarLine {
  Eigen::Vector2d at_infinity = Eigen::Vector2d::Zero();    ///< px
  Eigen::Vector2d per_disparity = Eigen::Vector2d::Zero();  ///< px per px

  Eigen::Vector2d at(const Eigen::Vector2d& pixel, double disparity) const {
    return pixel + at_infinity + disparity * (per_disparity - Eigen::Vector2d::UnitX());
  }
};

struct StereoMatch {
  double disparity = 0.0;                           ///< px, x_left - x_right; along the line
  int row_offset = 0;                               ///< px, off the line; y_right - y_left if it is a row
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< px, in the right image
  double correlation = 0.0;                         ///< normalised, of left and right patch
};

/// Finds the point at `left` (px, sub-pixel) of the left image in the right image, in the stages of the
/// thesis (4.1-4.4, 4.14): sum of absolute differences in the DoG pyramids, the whole range at the coarsest
/// level, then +-3 px at each finer one; normalised cross-correlation over +-settings.rows rows; sinusoidal
/// sub-pixel fit. Beyond the thesis, the best few candidates of the coarsest level go down together: a lone
/// one is lost where a near object stands before a far wall, and the runner-up tells whether the match is
/// ambiguous. No match: correlates too little, a rival correlates nearly as well, or outside the range of
/// disparity. `level` of the pyramids is the finest that is looked at, in place of the images themselves;
/// what is asked and answered is in px of the image all the same, but for the row offset and settings.rows.
std::optional<StereoMatch> matchStereo(const ImagePyramid& left_image, const ImagePyramid& right_image,
                                       const Eigen::Vector2d& left, const StereoSettings& settings,
                                       const EpipolarLine& line = {}, int level = 0);

}  // namespace cartvo
