// The choice of the method, and what holds for all.
#include "vo_core/stereo_odometry.hpp"

#include <stdexcept>
#include <string>

#include "vo_core/repeated_pictures.hpp"
#include "vo_core/reprojection_odometry.hpp"
#include "vo_core/thesis_odometry.hpp"

namespace cartvo {
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

/// As if the pair had not come: the pose is the last one that was known.
OdometryEstimate unknownSince(const OdometryEstimate& last, const StereoImages& images) {
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
    : camera_(camera), settings_(settings), repeated_(std::make_unique<RepeatedPictures>()) {
  validate(camera);
  validate(settings);
  method_ = makeMethod(camera, settings);
}

StereoOdometry::~StereoOdometry() = default;
StereoOdometry::StereoOdometry(StereoOdometry&&) noexcept = default;
StereoOdometry& StereoOdometry::operator=(StereoOdometry&&) noexcept = default;

void StereoOdometry::aimAt(int features) {
  settings_.features = features;
  validate(settings_);
  method_->aimAt(features);
}

void StereoOdometry::placeNext(StereoImages& images) {
  method_->placeNext(images);
}

OdometryEstimate StereoOdometry::process(const StereoImages& images, StageObserver& observer) {
  checkImage(images.left, camera_, "left");
  checkImage(images.right, camera_, "right");
  const PictureRepeats repeats = repeated_->take(images, last_);
  last_ = repeats.of_moving_cart ? unknownSince(last_, images) : method_->process(images, repeats, observer);
  return last_;
}

}  // namespace cartvo
