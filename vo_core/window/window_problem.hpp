#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "vo_core/geometry/fixed_vector.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/window/trajectory.hpp"

// The window of `estimator: reprojection` as plain data: trajectory, rig, landmarks, observations, noise and
// prior.

namespace cartvo::vo {

/// States that all pairs of a window share, as a vector: readouts of both cameras (s), error of the time
/// stamps' offset (s, right camera later), errors of the right camera (RigCorrection, normalised
/// coordinates), and `skew`, the row pattern x y of the lenses beyond that of yaw and p2.
enum SharedState : int {
  kLeftReadout,
  kRightReadout,
  kOffset,
  kPitch,
  kYaw,
  kRoll,
  kP2,
  kSkew,
  kSharedStates
};
using SharedVector = Eigen::Matrix<double, kSharedStates, 1>;
/// Number of states of the right camera's geometry: those from kPitch on.
constexpr int kRigStates = kSharedStates - kPitch;
/// Number of those of its lens, the last ones.
constexpr int kLensStates = kSharedStates - kP2;

/// Index of a knot's first unknown; each knot has six, after the shared states.
constexpr Eigen::Index columnOf(int knot) {
  return kSharedStates + 6 * static_cast<Eigen::Index>(knot);
}

/// A pair of images of the window.
struct WindowPair {
  std::int64_t index = -1;
  double time = 0.0;    ///< s, of the left exposure
  double offset = 0.0;  ///< s, right exposure minus left exposure by the time stamps
  /// Of the left camera's velocity, in the world's axes, and rate at `time`, given the shared states.
  Matrix6d twist_covariance = Matrix6d::Zero();
};

/// A landmark in both images of a pair: up to four coordinates, px, as seen.
struct WindowObservation {
  int pair = 0;         ///< index into WindowProblem::pairs
  bool stereo = false;  ///< whether `right` counts
  Eigen::Vector2d left = Eigen::Vector2d::Zero(), right = Eigen::Vector2d::Zero();
  /// Instants of both rows relative to the exposure of their image, as shares of the readout.
  double left_share = 0.0, right_share = 0.0;
  /// Stddev of each coordinate over the scale of WindowNoise.
  Eigen::Vector2d relative_noise = Eigen::Vector2d::Ones();
};

/// A landmark with three unknowns: its direction (x, y at z = 1) and its inverse depth (1/m, along z), both
/// in the axes of `T_world_host`. That is near the pose of its first camera and never changes: with a free
/// direction no residual depends on the host's error.
struct WindowLandmark {
  Eigen::Isometry3d T_world_host = Eigen::Isometry3d::Identity();
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< initial value, then result
  int level = 0;                                    ///< pyramid level, see Landmark
  FixedVector<WindowObservation, kMaximumWindowPairs> observations;
};

/// Student's t distributions of the coordinates of an observation in a pyramid level. The search in the right
/// image begins at the left position, so that both have a part of their errors in common.
struct WindowNoise {
  double left = 0.1, right = 0.1;  ///< scales, px of the full image; `right` beside the common part
  double common = 0.0;             ///< error of a right coordinate for that of the left one
};
using WindowNoises = std::array<WindowNoise, kLandmarkLevels>;

/// Root mean square of the trajectory's jerk, white over intervals: m/s^3 and rad/s^3.
struct WindowJerk {
  double translation = 66.0, rotation = 90.0;
};

/// Squares of weighted jerks over their rms (translation, rotation) and how many of them measurements tell:
/// those that follow from the prior alone do not count (D. MacKay, "Bayesian interpolation", 1992).
struct WindowJerkSums {
  Eigen::Vector2d squares = Eigen::Vector2d::Zero(), freedom = Eigen::Vector2d::Zero();
};

/// Weight of a jerk in the normal equations: a kerb is more than a normal distribution allows. `square`: of
/// its three components over their variance. At most 1, as jerks that nothing measures are zero.
inline double jerkWeight(double square) {
  constexpr double kFreedom = 4.0;  // of Student's t distribution
  return std::min(1.0, (kFreedom + 3.0) / (kFreedom + square));
}

/// Normal equations of what has left the window, about the first estimates of its unknowns: information times
/// (x - first) equals `vector`. Order: shared states, then six a knot (Trajectory::move()), oldest first.
struct WindowPrior {
  SharedVector first_shared = SharedVector::Zero();
  std::vector<Eigen::Isometry3d> first;  ///< knots
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(kSharedStates, kSharedStates);
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(kSharedStates);
  /// Appends the knots that the trajectory has beyond them; nothing is known about these.
  void extendTo(const Trajectory& trajectory);
  /// Marginalises the oldest knots: the Schur complement (G. Sibley et al., "Sliding window filter with
  /// application to planetary landing", 2010).
  void marginaliseOldest(int knots);
  /// Lets the shared states walk: adds these variances to them.
  void addSharedNoise(const SharedVector& variances);
  /// Difference of the unknowns from the first estimates.
  Eigen::VectorXd changeTo(const SharedVector& shared, const Trajectory& trajectory) const;
};

struct WindowProblem {
  StereoCamera camera;
  FixedVector<WindowPair, kMaximumWindowPairs> pairs;  ///< oldest first
  Trajectory trajectory;                               ///< initial value, then result
  SharedVector shared = SharedVector::Zero();          ///< initial value, then result
  std::vector<WindowLandmark> landmarks;               ///< initial values, then results
  WindowNoises noise;
  WindowJerk jerk;
  WindowPrior prior;

  double leftTime(int pair, double share) const { return pairs[pair].time + share * shared[kLeftReadout]; }
  double rightTime(int pair, double share) const {
    return pairs[pair].time + pairs[pair].offset + shared[kOffset] + share * shared[kRightReadout];
  }
};

}  // namespace cartvo::vo
