#pragma once

#include <vector>

#include "vo_core/fast_corners.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/spacing_grid.hpp"

namespace cartvo {

/// FAST in windows, each with its own threshold, which is adapted from image to image so that dark and
/// bright, rough and smooth parts of the image all give features: too few corners lower a window's threshold,
/// too many raise it. (The thesis' prose swaps the directions.)
class AdaptiveDetector {
 public:
  /// `features` are aimed at in the whole image.
  AdaptiveDetector(const DetectionSettings& settings, int features, const cv::Size& image_size);

  /// New corners that bring the number of features to its target, strongest first: window by window, then
  /// wherever strong corners are left. `alive`: features the image holds already, all in `spacing`; new ones
  /// keep its distance and are entered into it. Adapts the thresholds for the next image.
  std::vector<Corner> detect(const cv::Mat& image, const std::vector<Eigen::Vector2d>& alive,
                             SpacingGrid& spacing);

  int windowCount() const { return static_cast<int>(windows_.size()); }
  const cv::Rect& window(int index) const { return windows_[index]; }
  int threshold(int index) const;
  /// Corners of one window in the last image, after non-maximum suppression, and how many are aimed at: more
  /// than features, so that there is a choice.
  int cornerCount(int index) const { return corner_counts_[index]; }
  double cornerTarget() const { return corner_target_; }

 private:
  /// Of each window, strongest first; adapts the thresholds.
  std::vector<std::vector<Corner>> strongestCorners(const cv::Mat& image);
  void adaptThreshold(int index, int corners);
  int windowAt(double x, double y) const;

  DetectionSettings settings_;
  int features_;
  double corner_target_;
  cv::Size image_size_;
  int first_looks_;  ///< still to be had at the first image, whose thresholds are a mere guess
  std::vector<cv::Rect> windows_;
  std::vector<double> thresholds_;
  std::vector<int> corner_counts_;
  cv::Mat scores_;  ///< of the image's corners while they are looked for, else zero
};

}  // namespace cartvo
