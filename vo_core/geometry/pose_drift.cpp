// Propagation of pose covariances with noise and Gauss-Markov drift.
#include "vo_core/geometry/pose_drift.hpp"

#include <cmath>

namespace cartvo::vo {

PoseUncertainty afterMotion(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                            const Matrix6d& noise, const UncertaintySettings& settings) {
  const double correlation = std::exp(-1.0 / settings.drift_correlation_pairs);  // of the drift, per pair
  const Matrix6d stationary = settings.drift_ratio * noise;
  const Matrix6d carried = adjoint(motion.inverse());
  PoseUncertainty after;
  // The drift is constant in the camera's axes. A track that begins at speed has drift at once.
  after.drift = before.drift.isZero(0.0) ? stationary : before.drift;
  after.drift = correlation * correlation * after.drift + (1.0 - correlation * correlation) * stationary;
  after.pose_and_drift = correlation * carried * before.pose_and_drift;
  after.pose = carried * before.pose * carried.transpose() + after.pose_and_drift +
               after.pose_and_drift.transpose() + after.drift + noise;
  after.pose_and_drift += after.drift;
  return after;
}

}  // namespace cartvo::vo
