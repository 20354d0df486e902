#pragma once

namespace cartvo::calibrate {

/// Design parameters of a stereo rig, modelled as two parallel pinhole cameras without distortion, like
/// rectified images.
struct StereoDesign {
  double baseline = 0.0;      ///< m
  double focal_length = 0.0;  ///< px
  double image_width = 0.0;   ///< px
};

/// Focal length (px) of a lens and a sensor whose width of `sensor_width_mm` corresponds to `image_width`
/// pixels.
double focalLengthOfLens(double focal_length_mm, double sensor_width_mm, double image_width);

/// Focal length (px) of a horizontal angle of view (rad).
double focalLengthOfView(double horizontal_view, double image_width);

/// Horizontal angle of view, rad.
double horizontalView(const StereoDesign& design);

/// Disparity at a range (m): d = f b / Z, px.
double disparityAt(const StereoDesign& design, double range);

/// Standard deviation of the depth (m) at a range (m), for disparities with standard deviation
/// `disparity_noise` (px): from Z = f b / d, to first order, Z^2 / (f b) sigma_d (D. Gallup et al., "Variable
/// baseline/resolution stereo", CVPR 2008, equation 2).
double depthError(const StereoDesign& design, double disparity_noise, double range);

/// Range (m) up to which the depth error stays below `fraction` of the range.
double rangeOfRelativeError(const StereoDesign& design, double disparity_noise, double fraction);

/// Share (0 to 1) of the left image's width that the right camera also sees at a range (m): the right
/// camera's view is shifted by the baseline, and the view is Z W / f wide.
double overlapAt(const StereoDesign& design, double range);

}  // namespace cartvo::calibrate
