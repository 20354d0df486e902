#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/image/affine_alignment.hpp"
#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/image/shift_tracking.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/tracking/landmark.hpp"
#include "vo_core/tracking/landmark_detector.hpp"
#include "vo_core/tracking/pose_prediction.hpp"
#include "vo_core/tracking/row_correction.hpp"
#include "vo_core/tracking/spacing_grid.hpp"
#include "vo_core/tracking/window_frame.hpp"

namespace cartvo::vo {

/// The left image that landmarks are searched in.
struct TrackedImage {
  const std::vector<WindowFrame>& window;  ///< earlier pairs
  const ImagePyramid& left;
  std::int64_t frame;                               ///< index of its pair
  std::int64_t oldest_anchor;                       ///< index of a pair
  std::optional<Eigen::Isometry3d> T_world_camera;  ///< predicted pose, if any
  bool pose_is_found = false;  ///< whether the pose comes from landmarks of this image: the search trusts it
};

/// Correction of the predicted pose by the search.
struct TrackingOutcome {
  std::optional<Eigen::Isometry3d> T_world_camera;  ///< the prediction, corrected if it failed
  bool prediction_failed = false;
};

/// Tracks landmarks from pair to pair, matches them in the right images and detects new ones.
class LandmarkTracker {
 public:
  LandmarkTracker(const StereoCamera& camera, const OdometrySettings& settings);

  /// Sets the number of landmarks that replenish() targets, from the next pair on.
  void setTargetFeatureCount(int features);

  /// Searches each landmark of `previous` in the left image of a pair: first by a shift of the last pair's
  /// patch, then by an alignment with the anchor's patch. `tracked`: those found, each with an observation
  /// appended. A landmark whose anchor's patch no longer fits, or whose anchor is older than
  /// `image.oldest_anchor`, gets the last pair as its new anchor. A landmark that has come to lie where the
  /// image is masked counts as not found.
  ///
  /// Landmarks are searched near their predicted positions. If too few are found there, or those found are
  /// far from them, the prediction is corrected by the shift of the whole image, and the others are searched
  /// in all pyramid levels.
  TrackingOutcome track(const std::vector<Landmark>& previous, std::vector<Landmark>& tracked,
                        const TrackedImage& image);

  /// Removes landmarks that are too close to each other or exceed the target count, those with less weight
  /// and age first, and fills up with new corners.
  void replenish(std::vector<Landmark>& landmarks, const ImagePyramid& left, std::int64_t frame);

  /// Matches the landmarks' last observations, which must be in this pair, in the right image, where it is
  /// not masked.
  /// `right_from_left` is the predicted transform between the left and the right camera at their own exposure
  /// times, `T_world_camera` the predicted pose.
  void matchStereo(std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                   const ImagePyramid& left, const ImagePyramid& right, const RowTransform& right_from_left,
                   const Eigen::Isometry3d& T_world_camera) const;

 private:
  /// Left image in which landmarks are searched, the window and the predicted transforms.
  struct Scene {
    Scene(const std::vector<WindowFrame>& in, const ImagePyramid& image, std::int64_t index,
          const std::optional<Eigen::Isometry3d>& T_world_camera);
    bool hasPredictedPose() const { return !T_camera_frame.empty(); }

    const std::vector<WindowFrame>& window;
    const ImagePyramid& left;  ///< of the current pair
    std::int64_t frame;        ///< index of the current pair
    FixedVector<Eigen::Isometry3d, kMaximumWindowPairs>
        T_camera_frame;  ///< predicted, for each pair of the window; empty without a predicted pose
    FixedVector<Eigen::Isometry3d, kMaximumWindowPairs>
        T_last_frame;            ///< to the window's last pair, likewise
    bool wide = false;           ///< whether to search in all pyramid levels
    bool at_prediction = false;  ///< whether to align what no shift finds at the predicted pixels
  };

  /// Images of a stereo pair and their predicted geometry.
  struct StereoView {
    const ImagePyramid& left;
    const ImagePyramid& right;
    const RowTransform& right_from_left;  ///< predicted
  };

  /// State of the search for one landmark.
  struct TrackingAttempt {
    Eigen::Vector2d expected = Eigen::Vector2d::Zero();  ///< px, by the predicted pose
    std::optional<Eigen::Vector2d> shifted;  ///< px, by the last pair's patch; unset if the search failed
    std::optional<AffineAlignment> aligned;  ///< alignment with the anchor's patch
  };

  double predictedGrowth(const Landmark& landmark, const Scene& scene) const;
  std::optional<ShiftTask> startShift(Landmark& landmark, const Scene& scene,
                                      std::int64_t oldest_anchor) const;
  void shiftAll(std::span<Landmark> landmarks, const Scene& scene, std::int64_t oldest_anchor,
                std::span<TrackingAttempt> attempts) const;
  std::optional<Eigen::Vector2d> expectedPixel(const Landmark& landmark, int anchor,
                                               const Scene& scene) const;
  void alignWithAnchors(std::span<const Landmark> landmarks, const Scene& scene,
                        std::span<TrackingAttempt> attempts) const;
  void alignAtPrediction(std::span<const Landmark> landmarks, const Scene& scene,
                         std::span<TrackingAttempt> attempts) const;
  void trackBlock(std::span<Landmark> landmarks, const Scene& scene, std::int64_t oldest_anchor,
                  std::span<SearchResult> results) const;
  void trackAll(std::vector<Landmark>& landmarks, const Scene& scene, std::int64_t oldest_anchor,
                std::vector<SearchResult>& results) const;
  bool isFound(std::size_t landmark) const { return found_[landmark] != SearchResult::lost; }
  bool predictionFails() const;
  Eigen::Isometry3d searchWidely(const std::vector<Landmark>& previous, std::vector<Landmark>& tracked,
                                 const TrackedImage& image);
  std::optional<AffineAlignment> startInRight(const Landmark& landmark, const StereoView& view,
                                              double inverse_depth) const;
  double expectedInverseDepth(const Landmark& landmark, const Scene& scene) const;
  void matchBlock(std::span<Landmark> landmarks, const Scene& scene, const StereoView& view) const;

  StereoCamera camera_;
  OdometrySettings settings_;  ///< with nearestDisparity()
  LandmarkDetector detector_;
  // Memory of track(), reused.
  std::vector<SearchResult> found_;       ///< result for each landmark
  std::vector<SearchResult> found_wide_;  ///< the same of the wide search, for each of lost_
  std::vector<Landmark> lost_;            ///< landmarks of the wide search

  /// Memory of replenish(), reused so that the steady state allocates nothing.
  struct ReplenishBuffers {
    SpacingGrid spacing;
    std::vector<std::pair<double, std::size_t>> order;  ///< negative merit and index of each landmark
    std::vector<Landmark> kept;

    void reserve(std::size_t landmarks) {
      order.reserve(landmarks);
      kept.reserve(landmarks);
    }
  } buffers_;
};

}  // namespace cartvo::vo
