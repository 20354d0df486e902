// The facade: selects the estimator, checks the images and rejects repeated ones.
#include "vo_core/stereo_odometry.hpp"

#include <stdexcept>
#include <string>

#include "vo_core/integrity/integrity_monitor.hpp"
#include "vo_core/integrity/stereo_geometry_check.hpp"
#include "vo_core/reprojection_odometry.hpp"
#include "vo_core/thesis/thesis_odometry.hpp"

namespace cartvo::vo {
namespace {

void checkImage(const cv::Mat& image, const StereoCamera& camera, const char* name) {
  if (image.type() == CV_8UC1 && image.cols == camera.width && image.rows == camera.height) return;
  throw std::invalid_argument(std::string(name) + " image is " + std::to_string(image.cols) + "x" +
                              std::to_string(image.rows) + " of OpenCV type " + std::to_string(image.type()) +
                              ": expected " + std::to_string(camera.width) + "x" +
                              std::to_string(camera.height) + " of CV_8UC1");
}

std::unique_ptr<OdometryMethod> makeMethod(const StereoCamera& camera, const OdometrySettings& settings,
                                           const StereoShutters& shutters, const StereoMasks& masks) {
  if (settings.estimator == Estimator::thesis) return makeThesisOdometry(camera, settings, masks);
  return makeReprojectionOdometry(camera, settings, shutters, masks);
}

/// Estimate of a pair that is ignored: the last pose, as if the pair had not arrived.
OdometryEstimate rejected(const OdometryEstimate& last, const StereoImages& images, OdometryReason reason) {
  OdometryEstimate estimate;
  estimate.exposure_ns = images.left_exposure_ns;
  estimate.reasons = reason;
  estimate.reset_counter = last.reset_counter;
  estimate.T_world_camera = last.T_world_camera;
  estimate.pose_covariance = last.pose_covariance;
  estimate.rig = last.rig;
  return estimate;
}

}  // namespace

StereoOdometry::StereoOdometry(const StereoCamera& camera, const OdometrySettings& settings,
                               const StereoShutters& shutters, const StereoMasks& masks)
    : camera_(camera),
      settings_(settings),
      shutters_(shutters),
      masks_{masks.left.clone(), masks.right.clone()},
      integrity_(std::make_unique<IntegrityMonitor>(masks_)) {
  validate(camera);
  validate(settings);
  validate(shutters);
  validate(masks, camera);
  stereo_geometry_ = std::make_unique<StereoGeometryCheck>(camera);
  method_ = makeMethod(camera, settings, shutters, masks_);
}

StereoOdometry::~StereoOdometry() = default;
StereoOdometry::StereoOdometry(StereoOdometry&&) noexcept = default;
StereoOdometry& StereoOdometry::operator=(StereoOdometry&&) noexcept = default;

void StereoOdometry::setTargetFeatureCount(int features) {
  settings_.features = features;
  validate(settings_);
  method_->setTargetFeatureCount(features);
}

void StereoOdometry::acquireBuffers(StereoImages& images) {
  method_->acquireBuffers(images);
}

void StereoOdometry::viewLandmarks(LandmarkViews& views) const {
  if (last_.valid || method_is_new_ || last_.reasons == OdometryReason::first_pair)
    return method_->viewLandmarks(views);
  views.clear();
}

OdometryEstimate StereoOdometry::process(const StereoImages& images, StageObserver& observer) {
  checkImage(images.left, camera_, "left");
  checkImage(images.right, camera_, "right");
  integrity_->beginPair(images);
  const IntegrityEvidence& seen = integrity_->evidence();
  const StereoFault fault = stereo_geometry_->update(images, seen.anyRepeats());
  if (integrity_->update(seen) == IntegrityAction::reject) {
    last_ = rejected(last_, images, OdometryReason::repeated_picture);
  } else if (fault != StereoFault::none) {
    last_ = rejectWrongGeometry(images, fault);
  } else {
    last_ = method_->process(images, *integrity_, observer);
    last_.reset_counter += first_epoch_;
    method_is_new_ = false;
  }
  integrity_->endPair(last_);
  return last_;
}

/// Rejects the pair. What the method has learnt from earlier ones, such as depths and the rig's calibration
/// error, may be wrong for the same reason: it starts anew.
OdometryEstimate StereoOdometry::rejectWrongGeometry(const StereoImages& images, StereoFault fault) {
  OdometryEstimate estimate = rejected(last_, images, OdometryReason::wrong_stereo_geometry);
  estimate.stereo_fault = fault;
  integrity_->update({.no_track = true});
  estimate.rig.reset();
  if (method_is_new_) return estimate;
  method_ = makeMethod(camera_, settings_, shutters_, masks_);
  method_is_new_ = true;
  first_epoch_ = last_.reset_counter + 1;
  return estimate;
}

}  // namespace cartvo::vo
