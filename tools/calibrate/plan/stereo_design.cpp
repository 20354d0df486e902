// Depth error, field of view and overlap of a stereo design.
#include "tools/calibrate/plan/stereo_design.hpp"

#include <algorithm>
#include <cmath>

#include "calib/solver/calibration.hpp"

namespace cartvo::calibrate {

double focalLengthOfLens(double focal_length_mm, double sensor_width_mm, double image_width) {
  return focal_length_mm / sensor_width_mm * image_width;
}

double focalLengthOfView(double horizontal_view, double image_width) {
  return image_width / (2.0 * std::tan(horizontal_view / 2.0));
}

double horizontalView(const StereoDesign& design) {
  return 2.0 * std::atan(design.image_width / (2.0 * design.focal_length));
}

double disparityAt(const StereoDesign& design, double range) {
  return design.focal_length * design.baseline / range;
}

double depthError(const StereoDesign& design, double disparity_noise, double range) {
  return cartvo::calib::depthError(range, disparity_noise, design.focal_length, design.baseline);
}

double rangeOfRelativeError(const StereoDesign& design, double disparity_noise, double fraction) {
  return fraction * design.focal_length * design.baseline / disparity_noise;
}

double overlapAt(const StereoDesign& design, double range) {
  return std::max(0.0, 1.0 - disparityAt(design, range) / design.image_width);
}

}  // namespace cartvo::calibrate
