// Measurement and validation of the motion between two pairs from their features.
#include "vo_core/thesis/motion_measurement.hpp"

#include <algorithm>

#include "vo_core/geometry/plausible_motion.hpp"
#include "vo_core/thesis/feature_history.hpp"
#include "vo_core/thesis/window_refinement.hpp"

namespace cartvo::vo {
namespace {

/// Carries the point of an observation to the world, with its covariance in world axes.
EarlierPoint carryToWorld(const FeatureObservation& observation, const Eigen::Matrix3d& covariance,
                          const Eigen::Isometry3d& T_world_camera) {
  return {T_world_camera * observation.point,
          T_world_camera.linear() * covariance * T_world_camera.linear().transpose()};
}

/// Cell of the image that a pixel is in; features of a cell have correlated errors (window_refinement.hpp).
int refinementCellOf(const StereoCamera& camera, const Eigen::Vector2d& pixel) {
  const int column =
      std::clamp(static_cast<int>(pixel.x() * kCovarianceColumns / camera.width), 0, kCovarianceColumns - 1);
  const int row =
      std::clamp(static_cast<int>(pixel.y() * kCovarianceRows / camera.height), 0, kCovarianceRows - 1);
  return row * kCovarianceColumns + column;
}

}  // namespace

Eigen::Matrix3d MotionMeter::covarianceOf(const FeatureObservation& observation) const {
  const double near = settings_.motion.near_noise * observation.disparity;
  return pointCovariance(camera_, observation.point, settings_.motion.pixel_noise + near,
                         settings_.motion.disparity_noise + near);
}

MotionMeasurement MotionMeter::measure(const std::vector<Feature>& features, std::int64_t reference,
                                       std::int64_t current, double time_step) {
  MotionMeasurement measurement;
  std::vector<PointMatch> matches;
  for (const Feature& feature : features) {
    const FeatureObservation& now = feature.last();
    const FeatureObservation* then = feature.at(reference);
    if (now.frame != current || !now.matched() || then == nullptr || !then->matched()) continue;
    matches.push_back({then->point, now.point, covarianceOf(*then), covarianceOf(now), feature.weight});
  }
  measurement.matched = static_cast<int>(matches.size());
  if (measurement.matched < settings_.validity.minimum_matches) {
    measurement.reasons = OdometryReason::too_few_matches;
    return measurement;
  }
  const auto motion = estimateMotion(matches, settings_.motion, random_);
  if (!motion) {
    measurement.reasons = OdometryReason::too_few_inliers;
    return measurement;
  }
  measurement.T_reference_current = motion->T_reference_current;
  measurement.scale = motion->scale;
  measurement.inliers = motion->inliers;
  const ValiditySettings& validity = settings_.validity;
  if (motion->inliers < validity.minimum_inliers ||
      motion->inliers < validity.minimum_inlier_ratio * measurement.matched)
    measurement.reasons.add(OdometryReason::too_few_inliers);
  if (settings_.refinement.frames == 1 && motion->scale > settings_.motion.maximum_residual)
    measurement.reasons.add(OdometryReason::high_residual);
  if (!isPlausibleMotion(motion->T_reference_current, time_step, validity))
    measurement.reasons.add(OdometryReason::implausible_motion);
  return measurement;
}

void MotionMeter::refine(const std::vector<Feature>& features, const FrameWindow& window,
                         std::int64_t current, double time_step, MotionMeasurement& measurement) const {
  const FrameRecord& reference = *window.reference();
  const Eigen::Isometry3d T_world_reference = *reference.T_world_camera;
  const std::int64_t oldest =
      std::min(current - std::max(settings_.refinement.frames - 1, 1), reference.index);
  std::vector<RefinementFeature> refined_features;
  for (const Feature& feature : features) {
    const FeatureObservation& now = feature.last();
    if (now.frame != current || !now.matched()) continue;
    RefinementFeature refined{
        now.point, covarianceOf(now), feature.weight, refinementCellOf(camera_, now.left), {}};
    for (int back = 1; back < kHistoryLength; ++back) {
      const FeatureObservation& earlier = feature.observation(back);
      const FrameRecord* frame =
          earlier.frame >= oldest && earlier.matched() ? window.find(earlier.frame) : nullptr;
      if (frame != nullptr && frame->T_world_camera)
        refined.earlier.push_back(carryToWorld(earlier, covarianceOf(earlier), *frame->T_world_camera));
    }
    if (!refined.earlier.empty()) refined_features.push_back(std::move(refined));
  }
  const auto refine_from = [&](const Eigen::Isometry3d& start, double scale) {
    return refinePose(start, refined_features, scale, settings_.motion.radius, settings_.refinement);
  };
  RefinedPose refined = refine_from(T_world_reference * measurement.T_reference_current, measurement.scale);
  if (!refined.converged) {
    measurement.reasons = OdometryReason::too_few_inliers;
    return;
  }
  if (settings_.refinement.frames > 1) {
    // Horn's method has one weight for all directions of a point. Where few points are near, its motion may
    // leave large errors that are not the images': errors are validated after the refinement.
    if (refined.scale < measurement.scale) {
      const RefinedPose again = refine_from(refined.T_world_camera, refined.scale);
      if (again.converged) refined = again;
    }
    measurement.scale = refined.scale;
    if (measurement.scale > settings_.motion.maximum_residual) {
      measurement.reasons = OdometryReason::high_residual;
      return;
    }
    measurement.T_reference_current = orthonormalised(T_world_reference.inverse() * refined.T_world_camera);
  }
  measurement.covariance = refined.covariance;
  if (!isPlausibleMotion(measurement.T_reference_current, time_step, settings_.validity))
    measurement.reasons = OdometryReason::implausible_motion;
}

void MotionMeter::updateHistoryWeights(std::vector<Feature>& features, const FrameWindow& window,
                                       std::int64_t current, const Eigen::Isometry3d& T_world_camera,
                                       double scale) const {
  for (Feature& feature : features) {
    if (feature.last().frame != current) continue;
    const FeatureObservation* observations[3] = {&feature.observation(0), &feature.observation(1),
                                                 &feature.observation(2)};
    EarlierPoint points[3];
    bool complete = true;
    for (int i = 0; i < 3; ++i) {
      const FrameRecord* frame = i == 0 ? nullptr : window.find(observations[i]->frame);
      complete =
          complete && observations[i]->matched() && (i == 0 || (frame != nullptr && frame->T_world_camera));
      if (!complete) break;
      points[i] = carryToWorld(*observations[i], scale * scale * covarianceOf(*observations[i]),
                               i == 0 ? T_world_camera : *frame->T_world_camera);
    }
    if (!complete) continue;
    const WorldStep later{points[0].world - points[1].world, points[0].covariance + points[1].covariance};
    const WorldStep earlier{points[1].world - points[2].world, points[1].covariance + points[2].covariance};
    feature.weight = historyWeight(feature.weight, motionVariance(earlier, later), settings_.history);
  }
}

}  // namespace cartvo::vo
