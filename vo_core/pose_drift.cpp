// How errors of poses add up.
#include "vo_core/pose_drift.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {
namespace {

// Found on rendered worlds, by how the errors of poses grow from a stand and from a start at speed
// (docs/accuracy.md).
constexpr double kOwnShare = 0.5;     // of the noise, that is a pair's own
constexpr double kDriftShare = 0.2;   // of the noise, that the drift has at full image motion
constexpr double kFullMotion = 8.0;   // px; about half a patch
constexpr double kDriftPairs = 40.0;  // after which e^-1 of the drift is left

}  // namespace

PoseUncertainty afterMotion(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                            const MotionErrors& errors) {
  static const double kKept = std::exp(-1.0 / kDriftPairs);  // of the drift, from pair to pair
  const Matrix6d lasting = kDriftShare * std::min(errors.image_motion / kFullMotion, 1.0) * errors.noise;
  const Matrix6d carried = adjoint(motion.inverse());
  PoseUncertainty after;
  after.pose = carried * before.pose * carried.transpose();
  // In the camera's axes, which it goes on in. A track that begins at speed drifts at once.
  after.drift = before.drift.isZero(0.0) ? lasting : before.drift;
  after.pose_and_drift = carried * before.pose_and_drift;
  for (int pair = 0; pair < errors.pairs; ++pair) {
    after.drift = kKept * kKept * after.drift + (1.0 - kKept * kKept) * lasting;
    after.pose_and_drift *= kKept;
    after.pose += after.pose_and_drift + after.pose_and_drift.transpose() + after.drift;
    after.pose_and_drift += after.drift;
  }
  after.pose += kOwnShare * errors.noise;
  return after;
}

}  // namespace cartvo
