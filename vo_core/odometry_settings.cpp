// Validation of the settings.
#include "vo_core/odometry_settings.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace cartvo::vo {
namespace {

template <typename Number>
void requireRange(const char* name, Number value, Number low, Number high) {
  if (value >= low && value <= high) return;  // false for NaN
  std::ostringstream message;
  message << name << " is " << value << ": expected " << low << " to " << high;
  throw std::invalid_argument(message.str());
}

void validate(const DetectionSettings& settings) {
  requireRange("detection.levels", settings.levels, 1, kLandmarkLevels);
  requireRange("detection.window_columns", settings.window_columns, 1, 100);
  requireRange("detection.window_rows", settings.window_rows, 1, 100);
  requireRange("detection.minimum_threshold", settings.minimum_threshold, 1, 254);
  requireRange("detection.maximum_threshold", settings.maximum_threshold, settings.minimum_threshold, 254);
  requireRange("detection.initial_threshold", settings.initial_threshold, settings.minimum_threshold,
               settings.maximum_threshold);
}

void validate(const TrackingSettings& settings) {
  requireRange("tracking.levels", settings.levels, 1, 8);
  requireRange("tracking.iterations", settings.iterations, 1, 100);
  requireRange("tracking.convergence", settings.convergence, 1e-4, 1.0);
  requireRange("tracking.minimum_correlation", settings.minimum_correlation, -1.0, 1.0);
  requireRange("tracking.maximum_backward_error", settings.maximum_backward_error, 0.0, 100.0);
  requireRange("tracking.minimum_score", settings.minimum_score, 0.0, 4080.0);
  requireRange("tracking.minimum_distance", settings.minimum_distance, 1.0, 100.0);
  requireRange("tracking.search_again", settings.search_again, 0, kMaximumSearchAgain);
}

void validate(const StereoSettings& settings) {
  requireRange("stereo.minimum_disparity", settings.minimum_disparity, 0.01, 100.0);
  requireRange("stereo.maximum_disparity", settings.maximum_disparity, 16, 1024);
  requireRange("stereo.rows", settings.rows, 0, 3);
  requireRange("stereo.minimum_correlation", settings.minimum_correlation, -1.0, 1.0);
  requireRange("stereo.uniqueness", settings.uniqueness, 0.0, 1.0);
}

void validate(const MotionSettings& settings) {
  requireRange("motion.subsets", settings.subsets, 1, 10000);
  requireRange("motion.subset_size", settings.subset_size, 3, 100);
  requireRange("motion.iterations", settings.iterations, 1, 100);
  requireRange("motion.radius", settings.radius, 0.1, 100.0);
  requireRange("motion.pixel_noise", settings.pixel_noise, 0.001, 10.0);
  requireRange("motion.disparity_noise", settings.disparity_noise, 0.001, 10.0);
  requireRange("motion.near_noise", settings.near_noise, 0.0, 1.0);
}

void validate(const ValiditySettings& settings) {
  requireRange("validity.minimum_features", settings.minimum_features, 3, 20000);
  requireRange("validity.minimum_matches", settings.minimum_matches, 3, 20000);
  requireRange("validity.minimum_inliers", settings.minimum_inliers, 3, 20000);
  requireRange("validity.minimum_inlier_ratio", settings.minimum_inlier_ratio, 0.0, 1.0);
  requireRange("validity.maximum_residual", settings.maximum_residual, 0.1, 100.0);
  requireRange("validity.maximum_time_step", settings.maximum_time_step, 0.001, 60.0);
  requireRange("validity.maximum_offset", settings.maximum_offset, 0.0, 10.0);
  requireRange("validity.maximum_offset_uncertainty", settings.maximum_offset_uncertainty, 0.0, 10.0);
  requireRange("validity.maximum_speed", settings.maximum_speed, 0.1, 1000.0);
  requireRange("validity.maximum_rate", settings.maximum_rate, 0.01, 100.0);
  requireRange("validity.maximum_stddev", settings.maximum_stddev, 1e-4, 100.0);
}

}  // namespace

double minimumDistance(const OdometrySettings& settings, int width, int height) {
  const double spacing = std::sqrt(static_cast<double>(width) * height / settings.features);
  return std::max(std::min(settings.tracking.minimum_distance, 0.5 * spacing), 1.0);
}

int nearestDisparity(const StereoSettings& settings, int width) {
  return std::max(settings.maximum_disparity, width / 2);
}

void validate(const UncertaintySettings& settings) {
  requireRange("uncertainty.motion_noise_factor", settings.motion_noise_factor, 0.01, 100.0);
  requireRange("uncertainty.first_motion_inflation", settings.first_motion_inflation, 0.0, 1e3);
  requireRange("uncertainty.scale_stddev", settings.scale_stddev, 1e-6, 10.0);
  requireRange("uncertainty.independent_noise_ratio", settings.independent_noise_ratio, 0.0, 100.0);
  requireRange("uncertainty.drift_ratio", settings.drift_ratio, 0.0, 100.0);
  requireRange("uncertainty.full_image_motion", settings.full_image_motion, 0.1, 1e3);
  requireRange("uncertainty.drift_correlation_pairs", settings.drift_correlation_pairs, 1.0, 1e4);
  requireRange("uncertainty.standstill_translation", settings.standstill_translation, 1e-9, 1.0);
  requireRange("uncertainty.standstill_rotation", settings.standstill_rotation, 1e-9, 1.0);
}

void validate(const OdometrySettings& settings) {
  requireRange("features", settings.features, 50, 20000);
  validate(settings.detection);
  validate(settings.tracking);
  validate(settings.stereo);
  validate(settings.motion);
  requireRange("history.half_weight_stddevs", settings.history.half_weight_stddevs, 0.1, 100.0);
  requireRange("history.minimum_weight", settings.history.minimum_weight, 0.0, 1.0);
  requireRange("refinement.frames", settings.refinement.frames, 1, kMaximumRefinementFrames);
  requireRange("refinement.iterations", settings.refinement.iterations, 1, 100);
  requireRange("pose_search.subsets", settings.pose_search.subsets, 0, 10000);
  requireRange("pose_search.gate", settings.pose_search.gate, 0.1, 100.0);
  requireRange("pose_search.sufficient_support", settings.pose_search.sufficient_support, 0.0, 1.0);
  requireRange("pose_search.maximum_acceleration", settings.pose_search.maximum_acceleration, 0.1, 1e6);
  requireRange("pose_search.maximum_angular_acceleration", settings.pose_search.maximum_angular_acceleration,
               0.1, 1e6);
  requireRange("bundle.frames", settings.bundle.frames, 2, kMaximumWindowPairs - 1);
  requireRange("bundle.free_frames", settings.bundle.free_frames, 1, settings.bundle.frames);
  requireRange("bundle.convergence", settings.bundle.convergence, 0.0, 1.0);
  requireRange("bundle.prior_weight", settings.bundle.prior_weight, 0.0, 1e3);
  requireRange("bundle.fixed_pose_weight", settings.bundle.fixed_pose_weight, 0.0, 1.0);
  requireRange("bundle.iterations", settings.bundle.iterations, 1, 100);
  requireRange("bundle.robust_width", settings.bundle.robust_width, 0.1, 1000.0);
  validate(settings.uncertainty);
  requireRange("standstill.translation", settings.standstill.translation, 0.0, 1.0);
  requireRange("standstill.rotation", settings.standstill.rotation, 0.0, 1.0);
  requireRange("standstill.least_time", settings.standstill.least_time, 0.0, 3600.0);
  validate(settings.validity);
}

}  // namespace cartvo::vo
