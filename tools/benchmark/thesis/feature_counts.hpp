#pragma once

#include <filesystem>
#include <vector>

#include "vo_core/odometry_settings.hpp"

namespace cartvo::benchmark {

/// Number of corners per image and detection window over a sequence, and its variation: Figures 4-13 (fixed
/// FAST threshold) and 4-14 (adaptive thresholds) of the thesis. Corners are counted after non-maximum
/// suppression; the features are selected from them.
struct FeatureCountSeries {
  std::vector<int> corners;   ///< in each image
  std::vector<int> features;  ///< selected in each image, at the minimum distance

  double corners_mean = 0.0;
  double corners_stddev = 0.0;  ///< standard deviation over the images
  double features_mean = 0.0;
  double window_mean = 0.0;                ///< corners in a window
  double window_stddev_over_images = 0.0;  ///< standard deviation over the images, mean over the windows
  double window_stddev = 0.0;  ///< standard deviation over the windows of an image, mean over the images
  double window_target = 0.0;  ///< target number of corners per window
  double starved = 0.0;        ///< fraction of windows with less than half of the target
};

/// Detects features in each left image of an image folder independently.
FeatureCountSeries countFeatures(const std::filesystem::path& folder, const vo::DetectionSettings& settings,
                                 int features);

/// `settings` with the same threshold for all windows and images.
vo::DetectionSettings withFixedThreshold(vo::DetectionSettings settings);

}  // namespace cartvo::benchmark
