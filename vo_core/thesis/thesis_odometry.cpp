// The estimator of the thesis: process() runs its stages in order.
#include "vo_core/thesis/thesis_odometry.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/thesis/feature_set.hpp"
#include "vo_core/thesis/frame_window.hpp"
#include "vo_core/thesis/motion_measurement.hpp"

namespace cartvo::vo {
namespace {

class ThesisOdometry final : public OdometryMethod {
 public:
  ThesisOdometry(const StereoCamera& camera, const OdometrySettings& settings, const StereoMasks& masks)
      : camera_(camera),
        settings_(settings),
        left_mask_(masks.left),
        right_mask_(masks.right),
        features_(camera, settings),
        window_(std::max(settings.tracking.search_again + 1, settings.refinement.frames)),
        meter_(camera, settings) {}

  OdometryEstimate process(const StereoImages& images, IntegrityMonitor& integrity,
                           StageObserver& observer) override;
  void setTargetFeatureCount(int features) override { features_.setTargetFeatureCount(features); }
  void viewLandmarks(LandmarkViews& views) const override;

 private:
  void beginPair(std::int64_t exposure_ns);
  std::optional<Eigen::Isometry3d> predictedPose() const;
  void measureMotion();
  void refineMotion();
  OdometryEstimate finishPair();
  double secondsSince(const FrameRecord& frame) const {
    return 1e-9 * static_cast<double>(current_.exposure_ns - frame.exposure_ns);
  }

  StereoCamera camera_;
  OdometrySettings settings_;
  ImageMask left_mask_, right_mask_;
  FeatureSet features_;
  FrameWindow window_;  ///< the pairs before the current one
  MotionMeter meter_;

  std::uint32_t epoch_ = 0;
  std::int64_t next_index_ = 0;
  Eigen::Isometry3d T_world_camera_ = Eigen::Isometry3d::Identity();  ///< last known pose
  Matrix6d pose_covariance_ = Matrix6d::Zero();
  std::optional<Vector6d> velocity_;  ///< m/s and rad/s of the camera, in its axes, at the reference

  // State of the current pair.
  FrameRecord current_;
  MotionMeasurement motion_;
  FeatureCounts counts_;
};

void ThesisOdometry::viewLandmarks(LandmarkViews& views) const {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  views.clear();
  for (const Feature& feature : features_.features()) {
    if (!features_.isSeen(feature)) continue;
    LandmarkView view{.right_x = kUnknown,
                      .right_y = kUnknown,
                      .previous_x = kUnknown,
                      .previous_y = kUnknown,
                      .weight = 1.0F,
                      .age = feature.age(),
                      .inverse_depth = kUnknown};
    view.left_x = static_cast<float>(feature.last().left.x());
    view.left_y = static_cast<float>(feature.last().left.y());
    if (feature.age() > 1) {
      view.previous_x = static_cast<float>(feature.observation(1).left.x());
      view.previous_y = static_cast<float>(feature.observation(1).left.y());
    }
    if (feature.last().matched()) view.inverse_depth = static_cast<float>(1.0 / feature.last().point.z());
    views.push_back(view);
  }
}

OdometryEstimate ThesisOdometry::process(const StereoImages& images, IntegrityMonitor& integrity,
                                         StageObserver& observer) {
  beginPair(images.left_exposure_ns);
  ImagePyramid left;
  ImagePyramid right;
  {
    const StageScope stage(observer, Stage::pyramid);
    left = buildPyramid(images.left, settings_.tracking.levels);
    right = buildPyramid(images.right, 1);
    left.mask = left_mask_;
    right.mask = right_mask_;
  }
  {
    const StageScope stage(observer, Stage::optical_flow);
    features_.track(left, current_.index, window_, predictedPose());
  }
  SpacingGrid spacing(camera_.width, camera_.height,
                      minimumDistance(settings_, camera_.width, camera_.height));
  {
    const StageScope stage(observer, Stage::minimum_distance);
    features_.enforceMinimumDistance(spacing);
    counts_.tracked = features_.seenCount();
  }
  {
    const StageScope stage(observer, Stage::detect);
    features_.detect({images.left, &left_mask_}, spacing);
    counts_.detected = features_.seenCount();
  }
  {
    const StageScope stage(observer, Stage::disparity);
    features_.matchStereo(left, right);
    counts_.stereo = features_.matchedCount();
  }
  {
    const StageScope stage(observer, Stage::reproject);
    features_.triangulate();
  }
  {
    const StageScope stage(observer, Stage::motion);
    measureMotion();
  }
  {
    const StageScope stage(observer, Stage::weights);
    refineMotion();
  }
  current_.left.grey = std::move(left.grey);
  integrity.update({.tracked = motion_.valid(), .lost = !motion_.valid()});
  return finishPair();
}

/// Begins the pair. Features cannot be tracked across a time step out of range: starts a new epoch.
void ThesisOdometry::beginPair(std::int64_t exposure_ns) {
  current_ = FrameRecord{next_index_++, exposure_ns, {}, {}};
  motion_ = MotionMeasurement{};
  counts_ = FeatureCounts{};
  const FrameRecord* previous = window_.newest();
  if (previous == nullptr) {
    motion_.reasons = OdometryReason::first_pair;
    return;
  }
  const double step = secondsSince(*previous);
  if (step > 0.0 && step <= settings_.validity.maximum_time_step) return;
  motion_.reasons = OdometryReason::time_step;
  ++epoch_;
  window_.clear();
  features_.clear();
  velocity_.reset();
}

/// Pose at constant velocity; empty without a reference or a velocity.
std::optional<Eigen::Isometry3d> ThesisOdometry::predictedPose() const {
  const FrameRecord* reference = window_.reference();
  if (reference == nullptr || !velocity_) return std::nullopt;
  return *reference->T_world_camera * motionFromVector(secondsSince(*reference) * *velocity_);
}

/// Measures the motion since the reference or, if that is lost, since the previous pair, which starts a new
/// epoch.
void ThesisOdometry::measureMotion() {
  const FrameRecord* previous = window_.newest();
  if (previous == nullptr) return;
  const FrameRecord* reference = window_.reference();
  if (counts_.detected < settings_.validity.minimum_features) {
    motion_.reasons = OdometryReason::too_few_features;
    return;
  }
  motion_.reasons = OdometryReason::too_few_matches;
  if (reference != nullptr)
    motion_ =
        meter_.measure(features_.features(), reference->index, current_.index, secondsSince(*reference));
  if (motion_.valid() || reference == previous) return;

  const MotionMeasurement since_previous =
      meter_.measure(features_.features(), previous->index, current_.index, secondsSince(*previous));
  if (!since_previous.valid()) return;
  motion_ = since_previous;
  ++epoch_;
  window_.beginEpochAtNewest();
  pose_covariance_.setZero();
}

void ThesisOdometry::refineMotion() {
  if (!motion_.valid()) return;
  const FrameRecord& reference = *window_.reference();
  meter_.refine(features_.features(), window_, current_.index, secondsSince(reference), motion_);
  if (!motion_.valid()) return;
  current_.T_world_camera = orthonormalised(*reference.T_world_camera * motion_.T_reference_current);
  meter_.updateHistoryWeights(features_.features(), window_, current_.index, *current_.T_world_camera,
                              motion_.scale);
  features_.removeLowWeights();
}

/// Returns the estimate and adds the pair to the window.
OdometryEstimate ThesisOdometry::finishPair() {
  counts_.matched = motion_.matched;
  counts_.inliers = motion_.inliers;
  OdometryEstimate estimate;
  estimate.valid = motion_.valid();
  estimate.reasons = motion_.reasons;
  if (estimate.valid) {
    const FrameRecord& reference = *window_.reference();
    estimate.time_step = secondsSince(reference);
    estimate.T_previous_current = motion_.T_reference_current;
    estimate.motion_covariance = motion_.covariance;
    velocity_ = vectorFromMotion(motion_.T_reference_current) / estimate.time_step;
    T_world_camera_ = *current_.T_world_camera;
    pose_covariance_ = composedCovariance(pose_covariance_, motion_.T_reference_current, motion_.covariance);
  } else if (window_.newest() == nullptr) {  // the first pair, or the first after a step in time
    current_.T_world_camera = Eigen::Isometry3d::Identity();
    T_world_camera_.setIdentity();
    pose_covariance_.setZero();
  }
  estimate.exposure_ns = current_.exposure_ns;
  estimate.reset_counter = epoch_;
  estimate.T_world_camera = T_world_camera_;
  estimate.pose_covariance = pose_covariance_;
  estimate.counts = counts_;
  window_.push(std::move(current_));
  return estimate;
}

}  // namespace

std::unique_ptr<OdometryMethod> makeThesisOdometry(const StereoCamera& camera,
                                                   const OdometrySettings& settings,
                                                   const StereoMasks& masks) {
  return std::make_unique<ThesisOdometry>(camera, settings, masks);
}

}  // namespace cartvo::vo
