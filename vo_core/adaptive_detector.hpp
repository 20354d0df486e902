#pragma once

#include <vector>

#include "vo_core/fast_corners.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/spacing_grid.hpp"

namespace cartvo {

/// FAST in windows, each with its own threshold, which is adapted from image to image so that dark and
/// bright, rough and smooth parts of the image all give features: too few corners lower a window's threshold,
/// too many raise it. (The thesis' prose swaps the directions.) A window that wants none is not searched.
class AdaptiveDetector {
 public:
  /// `features` are aimed at in the whole image. `scale`: px of the spacing grid for each of the image.
  AdaptiveDetector(const DetectionSettings& settings, int features, const cv::Size& image_size,
                   double scale = 1.0);

  /// New corners that bring the number of features to its target, all windows having the same share,
  /// strongest first: window by window, then wherever strong corners are left. `alive`: features the image
  /// holds already, all in `spacing`; new ones keep its distance and are entered into it. Adapts the
  /// thresholds for the next image. Valid until the next call.
  const std::vector<Corner>& detect(const cv::Mat& image, const std::vector<Eigen::Vector2d>& alive,
                                    SpacingGrid& spacing);

  /// The same, `wanted` of each window and `room` for so many in all.
  const std::vector<Corner>& detect(const cv::Mat& image, const std::vector<int>& wanted, int room,
                                    SpacingGrid& spacing);

  /// From the next image on, so many features are aimed at.
  void aimAt(int features);

  int windowCount() const { return static_cast<int>(windows_.size()); }
  const cv::Rect& window(int index) const { return windows_[index]; }
  /// The window of a pixel of the image; the nearest one if it lies outside.
  int windowAt(double x, double y) const;
  int threshold(int index) const;
  /// Corners of one window in the last image, after non-maximum suppression, and how many are aimed at: more
  /// than features, so that there is a choice.
  int cornerCount(int index) const { return corner_counts_[index]; }
  double cornerTarget() const { return corner_target_; }

 private:
  /// Makes corners_ those of each window that wants some, heaps with the strongest first; adapts the
  /// thresholds.
  void findCorners(const cv::Mat& image, const std::vector<int>& wanted);
  /// Moves the strongest that are not too close to others to chosen_, until so many are; how many these are.
  int chooseFrom(std::vector<Corner>& heap, int wanted, SpacingGrid& spacing);
  void adaptThreshold(int index, int corners);

  DetectionSettings settings_;
  int features_;
  double corner_target_;
  double scale_;
  int first_looks_;  ///< still to be had at the first image, whose thresholds are a mere guess
  std::vector<cv::Rect> windows_;
  std::vector<int> column_of_, row_of_;  ///< among the windows, of each column and row of pixels
  std::vector<double> thresholds_;
  std::vector<int> corner_counts_;

  // Kept so that no image allocates anew.
  WindowThresholds window_thresholds_;
  std::vector<CornerFinder> finders_;  ///< one for each row of windows
  std::vector<std::vector<Corner>> corners_;
  std::vector<int> wanted_;
  std::vector<Corner> chosen_, left_over_;
};

}  // namespace cartvo
