#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/adaptive_detector.hpp"
#include "vo_core/feature.hpp"
#include "vo_core/frame_window.hpp"
#include "vo_core/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stereo_camera.hpp"

namespace cartvo {

/// All features that are followed, and the steps that bring them from one pair to the next. A feature is seen
/// if the current pair saw it, and lost otherwise.
class FeatureSet {
 public:
  FeatureSet(const StereoCamera& camera, const OdometrySettings& settings);

  void clear() { features_.clear(); }

  /// From the next pair on, so many features are aimed at.
  void aimAt(int features) { detector_.aimAt(features); }

  /// Follows each feature from the frame that saw it last, be it the one before or, for lost ones, up to
  /// `tracking.search_again` earlier (thesis 4.10-4.13). Where it should be is predicted from
  /// `T_world_camera`, the pose expected of the current pair, if there is one. What is not found for too
  /// long, or must have left the image, is dropped.
  void track(const ImagePyramid& left, std::int64_t frame, const FrameWindow& window,
             const std::optional<Eigen::Isometry3d>& T_world_camera);
  /// Of seen features closer than the minimum distance the older stays.
  void keepDistance(SpacingGrid& spacing);
  /// Fills up with new corners (thesis 4.9).
  void detect(const cv::Mat& left, SpacingGrid& spacing);
  /// Disparities of all seen features.
  void matchStereo(const ImagePyramid& left, const ImagePyramid& right);
  /// Points of all seen features that have a disparity (thesis 4.14).
  void triangulate();
  /// Drops features whose weight has fallen below the least.
  void removeUnweighted();

  std::vector<Feature>& features() { return features_; }
  const std::vector<Feature>& features() const { return features_; }
  bool seen(const Feature& feature) const { return feature.last().frame == frame_; }
  int seenCount() const;
  int matchedCount() const;  ///< of the seen, with a disparity

 private:
  Eigen::Vector2d predictPixel(const Feature& feature, const FrameWindow& window,
                               const std::optional<Eigen::Isometry3d>& T_world_camera) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  AdaptiveDetector detector_;
  std::vector<Feature> features_;
  std::int64_t frame_ = -1;
  std::uint64_t next_id_ = 0;
};

}  // namespace cartvo
