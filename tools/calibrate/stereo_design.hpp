#pragma once

namespace cartvo::calibrate {

/// What decides how well a pair of parallel cameras measures depth. Both are taken as pinholes without
/// distortion, as rectified images are.
struct StereoDesign {
  double baseline = 0.0;      ///< m
  double focal_length = 0.0;  ///< px
  double image_width = 0.0;   ///< px
};

/// Of a lens and the sensor behind it, px: a sensor's width of `sensor_width` holds `image_width` pixels.
double focalLengthOfLens(double focal_length_mm, double sensor_width_mm, double image_width);

/// Of a horizontal angle of view, rad, px.
double focalLengthOfView(double horizontal_view, double image_width);

/// Horizontal angle of view, rad.
double horizontalView(const StereoDesign& design);

/// d = f b / Z, px.
double disparityAt(const StereoDesign& design, double range);

/// Standard deviation of the depth at a range, m, where disparities have that of `disparity_noise` px: from
/// Z = f b / d, to first order, Z^2 / (f b) sigma_d (D. Gallup et al., "Variable baseline/resolution stereo",
/// CVPR 2008, equation 2).
double depthError(const StereoDesign& design, double disparity_noise, double range);

/// Up to this range, m, the depth's error stays below the `fraction` of the range.
double rangeOfRelativeError(const StereoDesign& design, double disparity_noise, double fraction);

/// How much of the left image's width the right camera sees too, of things at a range; 0 to 1. The right
/// camera's view is shifted by the baseline, and the view is Z W / f wide.
double overlapAt(const StereoDesign& design, double range);

}  // namespace cartvo::calibrate
