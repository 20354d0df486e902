#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "vo_core/feature.hpp"
#include "vo_core/frame_window.hpp"
#include "vo_core/motion_estimator.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// What a pair tells about the motion since a reference.
struct MotionMeasurement {
  OdometryReasons reasons;  ///< why it is not to be believed
  Eigen::Isometry3d T_reference_current = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< perturbation on the right
  double scale = 1.0;                      ///< see EstimatedMotion
  int matched = 0;
  int inliers = 0;

  bool valid() const { return reasons == OdometryReason::none; }
};

/// Measures the motion between two pairs (thesis 4.15, 4.16) from the features both have seen and matched.
class MotionMeter {
 public:
  MotionMeter(const StereoCamera& camera, const OdometrySettings& settings)
      : camera_(camera), settings_(settings), random_(settings.seed) {}

  /// Without covariance, which the refinement gives. `time_step` in s.
  MotionMeasurement measure(const std::vector<Feature>& features, std::int64_t reference,
                            std::int64_t current, double time_step);

  /// Lays the measured pose on the last frames (thesis 5.1), fills in the covariance, and judges the result.
  /// The poses in `window` must hold the reference's.
  void refine(const std::vector<Feature>& features, const FrameWindow& window, std::int64_t current,
              double time_step, MotionMeasurement& measurement) const;

  /// Renews the history weights of all features that three pairs in a row, `current` the last, have matched.
  void weighHistory(std::vector<Feature>& features, const FrameWindow& window, std::int64_t current,
                    const Eigen::Isometry3d& T_world_camera, double scale) const;

 private:
  Eigen::Matrix3d covarianceOf(const Observation& observation) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  SubsetRandom random_;
};

}  // namespace cartvo
