// Propagation of pose covariances with noise and Gauss-Markov drift.
#include "vo_core/geometry/pose_drift.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

// Fitted on rendered worlds to the growth of pose errors after a standstill and after a start at speed
// (docs/accuracy.md).
constexpr double kIndependentNoiseRatio = 0.5;   // of the noise covariance: independent in each pair
constexpr double kDriftRatio = 0.2;              // of the noise covariance: drift at full image motion
constexpr double kFullImageMotion = 8.0;         // px, half a patch; the drift saturates
constexpr double kDriftCorrelationPairs = 40.0;  // until e^-1 of the drift is left

}  // namespace

PoseUncertainty afterMotion(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                            const MotionErrors& errors) {
  static const double kCorrelation = std::exp(-1.0 / kDriftCorrelationPairs);  // of the drift, per pair
  const Matrix6d stationary =
      kDriftRatio * std::min(errors.image_motion / kFullImageMotion, 1.0) * errors.noise;
  const Matrix6d carried = adjoint(motion.inverse());
  PoseUncertainty after;
  after.pose = carried * before.pose * carried.transpose();
  // The drift is constant in the camera's axes. A track that begins at speed has drift at once.
  after.drift = before.drift.isZero(0.0) ? stationary : before.drift;
  after.pose_and_drift = carried * before.pose_and_drift;
  for (int pair = 0; pair < errors.pairs; ++pair) {
    after.drift =
        kCorrelation * kCorrelation * after.drift + (1.0 - kCorrelation * kCorrelation) * stationary;
    after.pose_and_drift *= kCorrelation;
    after.pose += after.pose_and_drift + after.pose_and_drift.transpose() + after.drift;
    after.pose_and_drift += after.drift;
  }
  after.pose += kIndependentNoiseRatio * errors.noise;
  return after;
}

}  // namespace cartvo::vo
