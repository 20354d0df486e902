#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/thesis/feature.hpp"
#include "vo_core/thesis/frame_window.hpp"
#include "vo_core/tracking/adaptive_detector.hpp"

namespace cartvo::vo {

/// All tracked features of `estimator: thesis`, with the operations that process one pair: tracking,
/// detection, stereo matching. A feature is seen if the current pair observed it, and lost otherwise.
class FeatureSet {
 public:
  FeatureSet(const StereoCamera& camera, const OdometrySettings& settings);

  void clear() { features_.clear(); }

  /// Sets the target number of features from the next pair on.
  void setTargetFeatureCount(int features) { detector_.setTargetFeatureCount(features); }

  /// Tracks each feature from the frame that observed it last: the previous one or, for lost features, one up
  /// to `tracking.search_again` earlier (thesis 4.10-4.13). Its position is predicted from `T_world_camera`,
  /// the predicted pose of the current pair, if there is one. Drops features that were not found for too long
  /// or must have left the image.
  void track(const ImagePyramid& left, std::int64_t frame, const FrameWindow& window,
             const std::optional<Eigen::Isometry3d>& T_world_camera);
  /// Drops the younger one of two seen features that are closer than the minimum distance.
  void enforceMinimumDistance(SpacingGrid& spacing);
  /// Adds new corners up to the target number (thesis 4.9).
  void detect(const DetectionImage& left, SpacingGrid& spacing);
  /// Measures the disparities of all seen features.
  void matchStereo(const ImagePyramid& left, const ImagePyramid& right);
  /// Computes the points of all seen features that have a disparity (thesis 4.14).
  void triangulate();
  /// Drops features whose weight is below history.minimum_weight.
  void removeLowWeights();

  std::vector<Feature>& features() { return features_; }
  const std::vector<Feature>& features() const { return features_; }
  bool isSeen(const Feature& feature) const { return feature.last().frame == frame_; }
  int seenCount() const;
  int matchedCount() const;  ///< seen features with a disparity

 private:
  Eigen::Vector2d predictPixel(const Feature& feature, const FrameWindow& window,
                               const std::optional<Eigen::Isometry3d>& T_world_camera) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  AdaptiveDetector detector_;
  std::vector<Feature> features_;
  std::int64_t frame_ = -1;
};

}  // namespace cartvo::vo
