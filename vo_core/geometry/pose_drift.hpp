#pragma once

#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {

/// Covariance of a pose relative to the first pose of its track. The error grows by noise that is independent
/// in each pair and by a drift that neighbouring pairs share, because they observe the same landmarks with
/// the same depth errors. The drift, an error per pair, is a first-order Gauss-Markov process (A. Gelb,
/// "Applied Optimal Estimation", 1974, ch. 3.8): its variance grows with the square of the number of pairs
/// within its correlation time and linearly afterwards. Perturbations are on the right, in the order (x, y,
/// z, rotation); m and rad.
struct PoseUncertainty {
  Matrix6d pose = Matrix6d::Zero();   ///< covariance of the pose
  Matrix6d drift = Matrix6d::Zero();  ///< covariance of the drift per pair; zero before the first motion
  Matrix6d pose_and_drift = Matrix6d::Zero();  ///< cross-covariance: pose (rows), drift (columns)
};

/// Propagates the covariance over a motion whose own covariance is `noise`.
PoseUncertainty afterMotion(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                            const Matrix6d& noise, const UncertaintySettings& settings);

}  // namespace cartvo::vo
