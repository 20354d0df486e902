// Validation of the settings.
#include "vo_core/odometry_settings.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/exact_text.hpp"
#include "vo_core/tuned_constants.hpp"

namespace cartvo::vo {
namespace {

template <typename Number>
void requireRange(const char* name, Number value, Number low, Number high) {
  if (value >= low && value <= high) return;  // false for NaN
  const auto text = [](Number number) { return roundedText(static_cast<double>(number)); };
  throw std::invalid_argument(std::string(name) + " is " + text(value) + ": expected " + text(low) + " to " +
                              text(high));
}

void validate(const MotionSettings& settings) {
  requireRange("motion.subsets", settings.subsets, 1, 10000);
  requireRange("motion.subset_size", settings.subset_size, 3, 100);
  requireRange("motion.iterations", settings.iterations, 1, 100);
  requireRange("motion.radius", settings.radius, 0.1, 100.0);
  requireRange("motion.pixel_noise", settings.pixel_noise, 0.001, 10.0);
  requireRange("motion.disparity_noise", settings.disparity_noise, 0.001, 10.0);
  requireRange("motion.maximum_residual", settings.maximum_residual, 0.1, 100.0);
  requireRange("motion.near_noise", settings.near_noise, 0.0, 1.0);
}

}  // namespace

double minimumDistance(const OdometrySettings& settings, int width, int height) {
  const double spacing = std::sqrt(static_cast<double>(width) * height / settings.features);
  return std::max(std::min(settings.tracking.minimum_distance, 0.5 * spacing), 1.0);
}

int nearestDisparity(int width) {
  return width / 2;
}

void validate(const OdometrySettings& settings) {
  for (const auto constants : {tunedConstants(), productLimits()})
    for (const TunedConstant& constant : constants)
      requireRange(constant.name, constant.value(settings), constant.low, constant.high);
  const DetectionSettings& detection = settings.detection;
  requireRange("detection.levels", detection.levels, 1, kLandmarkLevels);
  requireRange("detection.maximum_threshold", detection.maximum_threshold, detection.minimum_threshold, 254);
  requireRange("tracking.iterations", settings.tracking.iterations, 1, 100);
  requireRange("stereo.maximum_disparity", settings.stereo.maximum_disparity, 16, 1024);
  validate(settings.motion);
  requireRange("refinement.frames", settings.refinement.frames, 1, kMaximumRefinementFrames);
  requireRange("refinement.iterations", settings.refinement.iterations, 1, 100);
}

}  // namespace cartvo::vo
