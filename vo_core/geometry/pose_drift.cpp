// Propagation of pose covariances with noise and Gauss-Markov drift.
#include "vo_core/geometry/pose_drift.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {

PoseUncertainty afterMotion(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                            const MotionErrors& errors, const UncertaintySettings& settings) {
  const double correlation = std::exp(-1.0 / settings.drift_correlation_pairs);  // of the drift, per pair
  const Matrix6d stationary = settings.drift_ratio * std::min(errors.patch_motion, 1.0) * errors.noise;
  const Matrix6d carried = adjoint(motion.inverse());
  PoseUncertainty after;
  after.pose = carried * before.pose * carried.transpose();
  // The drift is constant in the camera's axes. A track that begins at speed has drift at once.
  after.drift = before.drift.isZero(0.0) ? stationary : before.drift;
  after.pose_and_drift = carried * before.pose_and_drift;
  for (int pair = 0; pair < errors.pairs; ++pair) {
    after.drift = correlation * correlation * after.drift + (1.0 - correlation * correlation) * stationary;
    after.pose_and_drift *= correlation;
    after.pose += after.pose_and_drift + after.pose_and_drift.transpose() + after.drift;
    after.pose_and_drift += after.drift;
  }
  after.pose += settings.independent_noise_ratio * errors.noise;
  return after;
}

}  // namespace cartvo::vo
