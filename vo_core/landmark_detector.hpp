#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "vo_core/adaptive_detector.hpp"
#include "vo_core/image_pyramid.hpp"
#include "vo_core/landmark.hpp"

namespace cartvo {

/// Where a new landmark may be, and the level of the pyramid whose corner it is.
struct LandmarkCorner {
  Eigen::Vector2d pixel;  ///< px of the image
  int level = 0;
  float score = 0.0F;
};

/// Of something, each level's part.
using LevelShares = std::array<double, kLandmarkLevels>;

/// Corners of an image and of its half, where noise is less: how many of which, and where, follows what of
/// late could be followed there. A window whose corners last gets more of the landmarks, one whose corners
/// leave the image or look like nothing gets less; and coarse corners, whose places are known less well, take
/// the place of fine ones where they last so much longer that they tell more: in the dark, above all.
class LandmarkDetector {
 public:
  /// `features` are aimed at in the whole image.
  LandmarkDetector(const DetectionSettings& settings, int features, const cv::Size& image_size);

  /// From the next image on, so many features are aimed at.
  void aimAt(int features);

  /// New corners that bring the number of landmarks to its target. `alive`: those that the image holds
  /// already, all in `spacing`; new ones keep its distance and are entered into it. Valid until the next
  /// call.
  const std::vector<LandmarkCorner>& detect(const ImagePyramid& image, const std::vector<Landmark>& alive,
                                            SpacingGrid& spacing);

  /// What became of one of the new corners: whether it could be followed.
  void learn(const Landmark& landmark, bool followed);

 private:
  /// What became of new corners of a window of late.
  struct Tries {
    double tried = 0.0, followed = 0.0;
  };
  struct Level {
    AdaptiveDetector detector;
    std::vector<Tries> tries;  ///< of each window
    std::vector<int> wanted;
  };

  int windowOf(int level, const Eigen::Vector2d& pixel) const;
  /// How much a window's corners of each level tell, for each that is tried.
  LevelShares worthOf(int window) const;
  /// Makes Level::wanted each window's share of the landmarks.
  void share();
  void forget();

  int features_;
  std::vector<Level> levels_;
  std::vector<LandmarkCorner> corners_;
};

}  // namespace cartvo
