#pragma once

#include <memory>

#include "vo_core/landmark_view.hpp"
#include "vo_core/odometry_estimate.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/shutter.hpp"
#include "vo_core/stage_observer.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/stereo_masks.hpp"

namespace cartvo::vo {

class IntegrityMonitor;
class OdometryMethod;
class StereoGeometryCheck;

/// Stereo visual odometry: estimates the motion of a stereo camera from rectified image pairs.
///
///   cartvo::vo::StereoCamera camera{.focal_length = 480.0, .cx = 340.0, .cy = 210.0,
///                               .baseline = 0.115, .width = 680, .height = 420};
///   cartvo::vo::StereoOdometry odometry(camera, cartvo::vo::OdometrySettings{});
///   cartvo::vo::NullStageObserver observer;
///   while (readPair(images)) {  // cartvo::vo::StereoImages
///     const cartvo::vo::OdometryEstimate estimate = odometry.process(images, observer);
///     if (estimate.valid) use(estimate.T_world_camera, estimate.pose_covariance);
///   }
///
/// Deterministic: the same images in the same order give the same estimates to the bit, whatever the number
/// of threads. It reads no clock and no file and writes no log.
///
/// Not thread-safe: an object must be used by one thread at a time. Different objects are independent.
/// Internally it uses OpenCV's thread pool (cv::setNumThreads).
class StereoOdometry {
 public:
  /// Throws std::invalid_argument that names the value if the camera, the settings, the shutters or the masks
  /// are out of range.
  StereoOdometry(const StereoCamera& camera, const OdometrySettings& settings,
                 const StereoShutters& shutters = {}, const StereoMasks& masks = {});
  ~StereoOdometry();
  StereoOdometry(StereoOdometry&&) noexcept;
  StereoOdometry& operator=(StereoOdometry&&) noexcept;

  /// Processes the next pair and returns the motion since the previous one. Throws std::invalid_argument if
  /// an image is not CV_8UC1 of the camera's size; never throws because of the content of images, see
  /// OdometryReason. Keeps no reference to the images except to buffers from acquireBuffers().
  OdometryEstimate process(const StereoImages& images, StageObserver& observer);

  /// Lends the buffers of the next pair: sets `images.left` and `images.right` to CV_8UC1 images of the
  /// camera's size. A pair that is written there is not copied by process(). They are valid until that call.
  /// Optional: other images are copied, and `estimator: thesis` lends no buffers and leaves `images`
  /// unchanged.
  void acquireBuffers(StereoImages& images);

  /// Sets OdometrySettings::features from the next pair on, for example to save time under load. Throws
  /// std::invalid_argument if it is out of range.
  void setTargetFeatureCount(int features);

  /// Sets `views` to the landmarks that were observed in the last pair, for a display. None after a pair that
  /// was not tracked. Changes no estimate.
  void viewLandmarks(LandmarkViews& views) const;

 private:
  OdometryEstimate rejectWrongGeometry(const StereoImages& images, StereoFault fault);

  StereoCamera camera_;
  OdometrySettings settings_;
  StereoShutters shutters_;
  StereoMasks masks_;
  std::unique_ptr<OdometryMethod> method_;
  std::unique_ptr<IntegrityMonitor> integrity_;
  std::unique_ptr<StereoGeometryCheck> stereo_geometry_;
  bool method_is_new_ = true;      ///< it has processed no pair
  std::uint32_t first_epoch_ = 0;  ///< reset_counter of the method's first epoch
  OdometryEstimate last_;          ///< of the last pair
};

}  // namespace cartvo::vo
