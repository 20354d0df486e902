#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "vo_core/odometry_estimate.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/thesis/feature.hpp"
#include "vo_core/thesis/frame_window.hpp"
#include "vo_core/thesis/motion_estimator.hpp"

// Measurement of the motion between two pairs by `estimator: thesis`, with covariance and validation.

namespace cartvo::vo {

/// Motion of a pair since a reference pair.
struct MotionMeasurement {
  OdometryReasons reasons;  ///< why it is invalid; none if it is valid
  Eigen::Isometry3d T_reference_current = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< perturbation on the right
  double scale = 1.0;                      ///< see EstimatedMotion
  int matched = 0;
  int inliers = 0;

  bool valid() const { return reasons == OdometryReason::none; }
};

/// Measures the motion between two pairs (thesis 4.15, 4.16) from the features that both observed and
/// matched.
class MotionMeter {
 public:
  MotionMeter(const StereoCamera& camera, const OdometrySettings& settings)
      : camera_(camera), settings_(settings), random_(settings.seed) {}

  /// Estimates the motion, without its covariance, which refine() computes. `time_step` in s.
  MotionMeasurement measure(const std::vector<Feature>& features, std::int64_t reference,
                            std::int64_t current, double time_step);

  /// Refines the measured pose against the last frames (thesis 5.1), computes its covariance and validates
  /// the result. `window` must contain a pose for the reference.
  void refine(const std::vector<Feature>& features, const FrameWindow& window, std::int64_t current,
              double time_step, MotionMeasurement& measurement) const;

  /// Updates the history weights of all features that three pairs in a row, `current` the last, have matched.
  void updateHistoryWeights(std::vector<Feature>& features, const FrameWindow& window, std::int64_t current,
                            const Eigen::Isometry3d& T_world_camera, double scale) const;

 private:
  Eigen::Matrix3d covarianceOf(const FeatureObservation& observation) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  SubsetRandom random_;
};

}  // namespace cartvo::vo
