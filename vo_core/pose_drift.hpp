#pragma once

#include "vo_core/rigid_motion.hpp"

namespace cartvo {

/// What is known of a pose against the first one of its track. Its error grows from pair to pair in two ways:
/// by noise, and by a drift that neighbouring pairs have in common, for they see the same landmarks with the
/// same wrong depths. The drift, an error per pair, is a first-order Gauss-Markov process (A. Gelb, "Applied
/// Optimal Estimation", 1974, ch. 3.8): what it adds to the variance grows with the square of the pairs for
/// as long as it lasts, and with their number later on. Covariances of perturbations on the right, in the
/// order (x, y, z, rotation); m and rad.
struct PoseUncertainty {
  Matrix6d pose = Matrix6d::Zero();            ///< of the pose
  Matrix6d drift = Matrix6d::Zero();           ///< of what the drift adds, a pair; zero: it has not begun
  Matrix6d pose_and_drift = Matrix6d::Zero();  ///< of the one (rows) with the other
};

/// What there is to know of a motion's errors.
struct MotionErrors {
  int pairs = 1;                      ///< that the motion took
  Matrix6d noise = Matrix6d::Zero();  ///< covariance of the new pose against the landmarks that it sees
  double image_motion = 0.0;  ///< px, mean, of the landmarks in a pair: where none moves, nothing drifts
};

/// After that motion.
PoseUncertainty afterMotion(const PoseUncertainty& before, const Eigen::Isometry3d& motion,
                            const MotionErrors& errors);

}  // namespace cartvo
