// The facade: selects the estimator, checks the images and rejects repeated ones.
#include "vo_core/stereo_odometry.hpp"

#include <stdexcept>
#include <string>

#include "vo_core/integrity/repeated_image_detector.hpp"
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

std::unique_ptr<OdometryMethod> makeMethod(const StereoCamera& camera, const OdometrySettings& settings) {
  if (settings.estimator == Estimator::thesis) return makeThesisOdometry(camera, settings);
  return makeReprojectionOdometry(camera, settings);
}

/// Estimate of a pair whose images repeat: the last pose, as if the pair had not arrived.
OdometryEstimate rejectRepeated(const OdometryEstimate& last, const StereoImages& images) {
  OdometryEstimate estimate;
  estimate.exposure_ns = images.left_exposure_ns;
  estimate.reasons = OdometryReason::repeated_picture;
  estimate.reset_counter = last.reset_counter;
  estimate.T_world_camera = last.T_world_camera;
  estimate.pose_covariance = last.pose_covariance;
  estimate.rig = last.rig;
  return estimate;
}

}  // namespace

StereoOdometry::StereoOdometry(const StereoCamera& camera, const OdometrySettings& settings)
    : camera_(camera), settings_(settings), repeated_images_(std::make_unique<RepeatedImageDetector>()) {
  validate(camera);
  validate(settings);
  method_ = makeMethod(camera, settings);
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

OdometryEstimate StereoOdometry::process(const StereoImages& images, StageObserver& observer) {
  checkImage(images.left, camera_, "left");
  checkImage(images.right, camera_, "right");
  const ImageRepeats repeats = repeated_images_->update(images, last_);
  last_ = repeats.while_moving ? rejectRepeated(last_, images) : method_->process(images, repeats, observer);
  return last_;
}

}  // namespace cartvo::vo
