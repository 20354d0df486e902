#pragma once

#include <vector>

#include "vo_core/image/image_mask.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/tracking/fast_corners.hpp"
#include "vo_core/tracking/spacing_grid.hpp"

namespace cartvo::vo {

/// A level of an image pyramid in which corners are detected.
struct DetectionImage {
  cv::Mat pixels;                   ///< CV_8UC1
  const ImageMask* mask = nullptr;  ///< no corner is detected where it allows no patch; nullptr: everywhere
  int level = 0;
};

/// FAST in windows, each with its own threshold, which adapts from image to image so that dark and bright,
/// rough and smooth parts of the image all give features: too few corners lower a window's threshold, too
/// many raise it. (The thesis' prose swaps the directions.) A window that needs no corners is not searched.
class AdaptiveDetector {
 public:
  /// `features`: target number in the whole image. `scale`: px of the spacing grid per px of the image.
  AdaptiveDetector(const DetectionSettings& settings, int features, const cv::Size& image_size,
                   double scale = 1.0);

  /// Finds new corners that bring the number of features to its target. Chooses the strongest of each window,
  /// with the same share for all windows, then the strongest of those left. `alive`: features that the image
  /// has already, all in `spacing`; new ones keep its distance and are inserted into it. Adapts the
  /// thresholds for the next image. Valid until the next call.
  const std::vector<Corner>& detect(const DetectionImage& image, const std::vector<Eigen::Vector2d>& alive,
                                    SpacingGrid& spacing);

  /// As above, with `wanted` corners per window and at most `room` in all.
  const std::vector<Corner>& detect(const DetectionImage& image, const std::vector<int>& wanted, int room,
                                    SpacingGrid& spacing);

  /// Sets the target number of features from the next image on.
  void setTargetFeatureCount(int features);

  int windowCount() const { return static_cast<int>(windows_.size()); }
  const cv::Rect& window(int index) const { return windows_[index]; }
  /// Index of the window that contains a pixel of the image; of the nearest one if it lies outside.
  int windowAt(double x, double y) const;
  int threshold(int index) const;
  /// Number of corners of a window in the last image, after non-maximum suppression, and its target: more
  /// than features, so that there is a choice.
  int cornerCount(int index) const { return corner_counts_[index]; }
  double cornerTarget() const { return corner_target_; }

 private:
  /// Finds the corners of each window that wants some, as heaps with the strongest first; adapts the
  /// thresholds.
  void findCorners(const DetectionImage& image, const std::vector<int>& wanted);
  /// Moves up to `wanted` of the strongest corners that keep the distance from the heap to chosen_; returns
  /// their number.
  int chooseFrom(std::vector<Corner>& heap, int wanted, SpacingGrid& spacing);
  void adaptThreshold(int index, int corners);

  DetectionSettings settings_;
  int features_;
  double corner_target_;
  double scale_;
  int initial_passes_;  ///< remaining passes over the first image, whose thresholds are a mere guess
  std::vector<cv::Rect> windows_;
  std::vector<int> column_of_, row_of_;  ///< column and row of windows of each column and row of pixels
  std::vector<double> thresholds_;
  std::vector<int> corner_counts_;

  // Kept so that no image allocates memory.
  WindowThresholds window_thresholds_;
  std::vector<CornerFinder> finders_;  ///< one for each row of windows
  std::vector<std::vector<Corner>> corners_;
  std::vector<int> wanted_;
  std::vector<Corner> chosen_, remaining_;
};

}  // namespace cartvo::vo
