#pragma once

#include <optional>

#include "vo_core/rigid_motion.hpp"

namespace cartvo {

/// A twist in body axes: velocity m/s, angular velocity rad/s.
struct Twist {
  Vector6d value = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

/// The velocity at the exposure of a pair. A motion gives its mean over the time step, which is half a frame
/// period old: at 1 m/s^2 and 18 fps 3 cm/s. Carried on by half the change since the mean before, it is of
/// now, but noisier; in each axis as much of that is done as makes the expected squared error least:
///
///   v = m1 + a g (m1 - m0),   g = h1 / (h1 + h0),   a = max(0, 1 - 2 / s)
///
/// with the means m0, m1 over the time steps h0, h1, and s the mean square of such changes over that of their
/// noise. (The noise: each pose errs by e, so that m1 = v + (e1 - e0) / h; then the error's variance over var
/// e / h^2 is (1 + a/2)^2 + (1 + a)^2 + a^2/4 + (1 - a)^2 (s - 1) 6/4, of which the derivative is set to
/// zero.)
///
/// The covariance holds the noise, what is not carried on, and what carrying on in a straight line leaves
/// over, the last two from what has been seen of changes so far. Not thread-safe.
class VelocityAtExposure {
 public:
  VelocityAtExposure();

  /// `mean`: over the last `time_step` (s, positive), with its covariance.
  Twist next(const Twist& mean, double time_step);

  /// The cart stands: known, not measured, so that it says nothing of how velocity changes.
  void stand(double time_step);

  /// The next motion does not follow on the last one.
  void forget();

 private:
  struct Mean {
    Vector6d value = Vector6d::Zero();
    double time_step = 0.0;
  };

  /// Mean of outer products, of changes per second and of changes of that; new ones count more than old ones.
  Matrix6d changes_, bends_;
  std::optional<Mean> last_;
  std::optional<Vector6d> last_slope_;  ///< change per second of the mean
};

}  // namespace cartvo
