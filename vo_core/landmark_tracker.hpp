#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vo_core/affine_alignment.hpp"
#include "vo_core/image_pyramid.hpp"
#include "vo_core/landmark.hpp"
#include "vo_core/landmark_detector.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/pose_drift.hpp"
#include "vo_core/reprojection.hpp"
#include "vo_core/shift_tracking.hpp"
#include "vo_core/spacing_grid.hpp"
#include "vo_core/stereo_camera.hpp"

namespace cartvo {

/// A pair in the window: what is kept of it once it is processed.
struct WindowFrame {
  std::int64_t index = -1;
  std::int64_t exposure_ns = 0;  ///< of the left image
  double offset = 0.0;           ///< s, right exposure minus left exposure
  SharedPyramid left;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  PoseUncertainty uncertainty;                   ///< against the first pair
  Matrix6d local_covariance = Matrix6d::Zero();  ///< against the landmarks of its time
  Vector6d by_late_right = Vector6d::Zero();     ///< as TimedPose's
  /// Error of the pose against the first pair's if all offsets are off by one standard deviation, to the same
  /// side. Not in `uncertainty`.
  Vector6d offset_error = Vector6d::Zero();
};

/// Follows landmarks from pair to pair, finds them in the right images and adds new ones.
class LandmarkTracker {
 public:
  LandmarkTracker(const StereoCamera& camera, const OdometrySettings& settings);

  /// From the next pair on, so many landmarks are aimed at.
  void aimAt(int features);

  /// Looks for each landmark in the left image of pair `frame`, first where the last pair's patch has gone,
  /// then by the host's patch. Appends a sighting to those that are found and drops the others.
  /// `T_world_camera`: the expected pose of that pair, if there is one. A landmark whose host's patch no
  /// longer fits, or whose host is older than `oldest_host`, gets the last pair as its new host.
  void follow(std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
              const ImagePyramid& left, std::int64_t frame, std::int64_t oldest_host,
              const std::optional<Eigen::Isometry3d>& T_world_camera);

  /// Of landmarks closer to each other than the minimum distance, and of more than are aimed at, the more
  /// trusted and older stay; then fills up with new corners.
  void renew(std::vector<Landmark>& landmarks, const ImagePyramid& left, std::int64_t frame);

  /// Looks for the landmarks' last sightings, which are of this pair, in the right image. `T_right_left`: the
  /// right camera at its own instant as expected from the left one at its; `T_world_camera` the expected
  /// pose.
  void matchStereo(std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                   const ImagePyramid& left, const ImagePyramid& right, const Eigen::Isometry3d& T_right_left,
                   const Eigen::Isometry3d& T_world_camera) const;

 private:
  /// What landmarks are looked for in.
  struct Scene {
    Scene(const std::vector<WindowFrame>& in, const ImagePyramid& image, std::int64_t index,
          const std::optional<Eigen::Isometry3d>& T_world_camera);
    bool poseExpected() const { return !T_camera_frame.empty(); }

    const std::vector<WindowFrame>& window;
    const ImagePyramid& left;  ///< of the pair
    std::int64_t frame;        ///< the pair's index
    FixedVector<Eigen::Isometry3d, kMostWindowPairs>
        T_camera_frame;  ///< expected, of the window's pairs; empty: nobody knows
  };

  /// What landmarks are matched between.
  struct StereoView {
    const ImagePyramid& left;
    const ImagePyramid& right;
    const Eigen::Isometry3d& T_right_left;  ///< as expected
    WarpModel warp_model;
  };

  /// How far the search for a landmark has come.
  struct Pursuit {
    std::optional<Eigen::Vector2d> shifted;  ///< where the last pair's patch has gone; nothing: given up
    std::optional<AffineAlignment> aligned;  ///< with the host's patch
  };

  std::optional<ShiftTask> startShift(Landmark& landmark, const Scene& scene, std::int64_t oldest_host) const;
  void shiftAll(std::span<Landmark> landmarks, const Scene& scene, std::int64_t oldest_host,
                std::span<Pursuit> pursuits) const;
  std::optional<Eigen::Vector2d> expectedPixel(const Landmark& landmark, int host, const Scene& scene) const;
  void alignWithHosts(std::span<const Landmark> landmarks, const Scene& scene,
                      std::span<Pursuit> pursuits) const;
  void followBlock(std::span<Landmark> landmarks, const Scene& scene, std::int64_t oldest_host,
                   std::span<unsigned char> found) const;
  std::optional<AffineAlignment> startInRight(const Landmark& landmark, const StereoView& view,
                                              double inverse_depth) const;
  double expectedInverseDepth(const Landmark& landmark, const Scene& scene) const;
  void matchBlock(std::span<Landmark> landmarks, const Scene& scene, const StereoView& view) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  LandmarkDetector detector_;
  std::vector<unsigned char> found_;  ///< by follow(), of each landmark; kept for its memory

  /// What renew() works with, kept so that no pair allocates it anew.
  struct Renewal {
    SpacingGrid spacing;
    std::vector<std::pair<double, std::size_t>> order;  ///< of the landmarks, by merit, negative
    std::vector<Landmark> kept;

    void reserve(std::size_t landmarks) {
      order.reserve(landmarks);
      kept.reserve(landmarks);
    }
  } renewal_;
};

/// Whether the right camera, at its own instant, stands beside the left one at its, so that each point is
/// seen in the same row by both; one that has driven on since does not.
bool keepsRows(const Eigen::Isometry3d& T_right_left);

/// Where the window has the pair of that index, or -1; and that pair, or nullptr.
int placeOf(const std::vector<WindowFrame>& window, std::int64_t index);
const WindowFrame* findFrame(const std::vector<WindowFrame>& window, std::int64_t index);

}  // namespace cartvo
