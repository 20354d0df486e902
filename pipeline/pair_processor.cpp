// Processes a pair of frames: rectification, odometry, body motion, velocity at the exposure, its bounds.
#include "pipeline/pair_processor.hpp"

#include <array>
#include <cstdint>
#include <utility>

#include "calib/rectification/rectifier.hpp"
#include "common/picture_digest.hpp"
#include "common/threads/parallel_loop.hpp"
#include "pipeline/body_motion.hpp"
#include "pipeline/picture_light.hpp"

namespace cartvo::pipeline {
namespace {

constexpr std::int64_t kLightInterval_ns = 400'000'000;  // so that each health message has a measurement

Eigen::Isometry3d rotationOnly(const Eigen::Matrix3d& rotation) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = rotation;
  return transform;
}

}  // namespace

vo::StereoCamera stereoCamera(const calib::Rectification& rectification) {
  vo::StereoCamera camera;
  camera.focal_length = rectification.focal_length;
  camera.cx = rectification.cx;
  camera.cy = rectification.cy;
  camera.baseline = rectification.baseline;
  camera.width = rectification.size.width;
  camera.height = rectification.size.height;
  return camera;
}

class PairProcessor::Implementation {
 public:
  Implementation(const calib::Rig& rig, calib::Rectifier rectifier, const PairProcessorSettings& settings)
      : rectifier_(std::move(rectifier)),
        used_{rig.left.mask.used, rig.right.mask.used},
        T_left_rectified_(rotationOnly(rectifier_.rectification().R_rectified_left.transpose())),
        T_body_rectified_(rig.T_body_camera * T_left_rectified_),
        scale_stddev_(rig.scale_stddev),
        odometry_(stereoCamera(rectifier_.rectification()), settings.odometry,
                  stereoShutters(rig, rectifier_.rectification(), settings.absent_readout),
                  {rectifier_.leftMask(), rectifier_.rightMask()}),
        levels_(T_body_rectified_, scale_stddev_, settings.odometry.uncertainty),
        alert_limits_(settings.alert_limits),
        features_(settings.odometry.features) {}

  PairResult process(const capture::FramePair& pair) {
    PairResult result;
    result.sequence = next_sequence_++;
    result.left = pair.left;
    result.right = pair.right;

    PairView* const view = viewer_ == nullptr ? nullptr : viewer_->nextView();
    clock_.startPair();
    rectify(pair, view);
    measureLight(pair, result);
    result.features = features_;
    result.estimate = odometry_.process(images_, clock_);
    result.motion = bodyMotion(result.estimate, T_body_rectified_, scale_stddev_);
    extrapolateVelocity(result);
    if (result.estimate.valid && result.estimate.twist)
      setTwist(result.motion, *result.estimate.twist, T_body_rectified_, scale_stddev_);
    holdToAlertLimits(result);
    result.times = clock_.endPair();
    if (view != nullptr) complete(*view, result);
    return result;
  }

  void setTargetFeatureCount(int features) {
    if (features == features_) return;
    odometry_.setTargetFeatureCount(features);
    features_ = features;
  }
  int features() const { return features_; }
  void setViewer(PairViewer& viewer) { viewer_ = &viewer; }

  const calib::Rectifier& rectifier() const { return rectifier_; }
  const Eigen::Isometry3d& T_left_rectified() const { return T_left_rectified_; }

 private:
  void extrapolateVelocity(PairResult& result) {
    const double time_step = result.estimate.time_step;
    if (!result.estimate.valid || !(time_step > 0.0)) return velocity_.reset();
    if (result.estimate.reasons == vo::OdometryReason::zero_velocity)
      return velocity_.setStandstill(time_step);
    Twist mean;
    mean.value << result.motion.velocity, result.motion.angular_velocity;
    // Errors shared by consecutive velocities are not noise of their change.
    const vo::Vector6d& by_scale = result.motion.twist_scale_error;
    const vo::Matrix6d shared = by_scale * by_scale.transpose();
    mean.covariance = result.motion.twist_covariance - shared;
    const Twist now = velocity_.extrapolate(mean, time_step);
    result.motion.velocity = now.value.head<3>();
    result.motion.angular_velocity = now.value.tail<3>();
    result.motion.twist_covariance = now.covariance + shared;
  }

  /// The estimator goes on with what is not known well enough to be published.
  void holdToAlertLimits(PairResult& result) {
    result.level = levels_.update(result.estimate, result.motion);
    if (!result.motion.velocity.allFinite()) return;
    result.worst = worstBound(result.level, alert_limits_);
    if (result.worst->isExceeded()) eraseTwist(result.motion);
    if (result.isValid()) levels_.setValid();
  }

  void complete(PairView& view, const PairResult& result) const {
    odometry_.viewLandmarks(view.landmarks);
    view.still_regions = result.estimate.still_regions;
    view.times = result.times;
  }

  void measureLight(const capture::FramePair& pair, PairResult& result) {
    const std::int64_t since_ns = pair.left.exposure_ns - light_ns_;
    if (light_ns_ != 0 && since_ns >= 0 && since_ns < kLightInterval_ns) return;
    light_ns_ = pair.left.exposure_ns;
    auto& light = result.light.emplace();
    doBoth([&] { light[0] = pipeline::measureLight(pair.left.image, used_[0]); },
           [&] { light[1] = pipeline::measureLight(pair.right.image, used_[1]); });
  }

  /// `view`: where to copy the rectified pictures; nullptr: not wanted.
  void rectify(const capture::FramePair& pair, PairView* view) {
    // Time steps by the left camera's own clock: corrections of the exposures are no motion.
    images_.left_exposure_ns = pair.left.exposure_ns - pair.left.slew_ns;
    images_.right_exposure_ns = images_.left_exposure_ns + pair.offsetNs();
    images_.offset_stddev = 1e-9 * pair.offsetStddevNs();
    images_.key_frames = {pair.left.key_frame, pair.right.key_frame};
    clock_.begin(vo::Stage::rectify);
    odometry_.acquireBuffers(images_);
    doBoth(
        [&] {
          images_.left_digest = pictureDigest(pair.left.image);
          rectifier_.rectifyLeft(bands_[0].without(pair.left.image), images_.left);
          if (view != nullptr) images_.left.copyTo(view->left);
        },
        [&] {
          images_.right_digest = pictureDigest(pair.right.image);
          rectifier_.rectifyRight(bands_[1].without(pair.right.image), images_.right);
          if (view != nullptr) images_.right.copyTo(view->right);
        });
    clock_.end(vo::Stage::rectify);
  }

  calib::Rectifier rectifier_;
  std::array<LampBands, 2> bands_;
  std::array<cv::Mat, 2> used_;  ///< masks of the raw pictures; may be empty
  Eigen::Isometry3d T_left_rectified_;
  Eigen::Isometry3d T_body_rectified_;
  double scale_stddev_;
  vo::StereoImages images_;  ///< rectified; in the odometry's buffers, or kept to reuse their memory
  vo::StereoOdometry odometry_;
  ProtectionLevels levels_;
  AlertLimits alert_limits_;
  int features_;
  VelocityAtExposure velocity_;
  StageClock clock_;
  std::int64_t light_ns_ = 0;  ///< exposure of the last pair whose light was measured
  PairViewer* viewer_ = nullptr;
  std::uint64_t next_sequence_ = 0;
};

PairProcessor::PairProcessor(const calib::Rig& rig, calib::Rectifier rectifier,
                             const PairProcessorSettings& settings)
    : implementation_(std::make_unique<Implementation>(rig, std::move(rectifier), settings)) {}
PairProcessor::~PairProcessor() = default;
PairProcessor::PairProcessor(PairProcessor&&) noexcept = default;
PairProcessor& PairProcessor::operator=(PairProcessor&&) noexcept = default;

PairResult PairProcessor::process(const capture::FramePair& pair) {
  return implementation_->process(pair);
}
void PairProcessor::setTargetFeatureCount(int features) {
  implementation_->setTargetFeatureCount(features);
}
int PairProcessor::features() const {
  return implementation_->features();
}
void PairProcessor::setViewer(PairViewer& viewer) {
  implementation_->setViewer(viewer);
}
const calib::Rectifier& PairProcessor::rectifier() const {
  return implementation_->rectifier();
}
Eigen::Isometry3d PairProcessor::T_left_rectified() const {
  return implementation_->T_left_rectified();
}

}  // namespace cartvo::pipeline
