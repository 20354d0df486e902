#pragma once

#include <filesystem>
#include <vector>

#include "vo_core/odometry_settings.hpp"

namespace cartvo::benchmark {

/// How many corners detection finds over the images of a sequence, and how evenly: the thesis' Figures 4-13
/// (a fixed FAST threshold) and 4-14 (adaptive ones). Corners are those after non-maximum suppression, from
/// which the features are chosen.
struct FeatureCountSeries {
  std::vector<int> corners;   ///< in each image
  std::vector<int> features;  ///< chosen of them, at their minimum distance

  double corners_mean = 0.0;
  double corners_deviation = 0.0;  ///< standard deviation over the images
  double features_mean = 0.0;
  double window_mean = 0.0;                   ///< corners in a window
  double window_deviation_over_images = 0.0;  ///< standard deviation over the images, mean over the windows
  double window_deviation = 0.0;  ///< standard deviation over the windows of an image, mean over the images
  double window_target = 0.0;     ///< corners that are aimed at in a window
  double starved = 0.0;           ///< of the windows, with less than half of the target
};

/// Detects anew in each left image of an image folder.
FeatureCountSeries countFeatures(const std::filesystem::path& folder, const DetectionSettings& settings,
                                 int features);

/// The same with one threshold for all windows and images, the initial one.
DetectionSettings withFixedThreshold(DetectionSettings settings);

}  // namespace cartvo::benchmark
