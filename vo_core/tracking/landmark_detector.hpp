#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/tracking/adaptive_detector.hpp"
#include "vo_core/tracking/landmark.hpp"

// Detection of corners for new landmarks in two pyramid levels.

namespace cartvo::vo {

/// Corner for a new landmark and the pyramid level in which it was found.
struct LandmarkCorner {
  Eigen::Vector2d pixel;  ///< px of the image
  int level = 0;
  float score = 0.0F;
};

/// One value per pyramid level.
using LevelShares = std::array<double, kLandmarkLevels>;

/// Detects corners in an image and in its half, where noise is lower. Their distribution over windows and
/// levels follows recent tracking success. A window whose corners last gets more of the landmarks; one whose
/// corners leave the image or cannot be tracked gets fewer. Coarse corners, whose positions are less precise,
/// replace fine ones where they last so much longer that they give more information: mostly in the dark.
class LandmarkDetector {
 public:
  /// `features`: target number in the whole image.
  LandmarkDetector(const DetectionSettings& settings, int features, const cv::Size& image_size);

  /// Sets the target number of features from the next image on.
  void setTargetFeatureCount(int features);

  /// Finds new corners that bring the number of landmarks to its target. `alive`: landmarks that the image
  /// has already, all in `spacing`; new ones keep its distance and are inserted into it. Valid until the next
  /// call.
  const std::vector<LandmarkCorner>& detect(const ImagePyramid& image, const std::vector<Landmark>& alive,
                                            SpacingGrid& spacing);

  /// Records whether a new corner could be tracked.
  void recordOutcome(const Landmark& landmark, bool tracked);

 private:
  /// Recent trials of new corners in a window and how many of them were tracked.
  struct TrialCounts {
    double attempted = 0.0, tracked = 0.0;
  };
  struct Level {
    AdaptiveDetector detector;
    std::vector<TrialCounts> trials;  ///< of each window
    std::vector<int> wanted;
  };

  int windowOf(int level, const Eigen::Vector2d& pixel) const;
  /// Information that a corner of a window gives per trial, for each level: its success rate, smoothed by
  /// Laplace's rule, over the square of its noise.
  LevelShares utilityOf(int window) const;
  /// Sets Level::wanted to each window's share of the landmarks.
  void distributeTargets();
  void decayTrials();

  DetectionSettings settings_;
  int features_;
  std::vector<Level> levels_;
  std::vector<LandmarkCorner> corners_;
};

}  // namespace cartvo::vo
