#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/geometry/fixed_vector.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"
#include "vo_core/stereo_camera.hpp"

// Reprojection of landmarks into both cameras of a pair, each at its own exposure instant, with derivatives.

namespace cartvo::vo {

/// A pair in the estimator: the pose of the left camera at its exposure, and the time offset of the right
/// one.
struct TimedPose {
  double time = 0.0;    ///< s, of the left exposure, since any fixed instant
  double offset = 0.0;  ///< s, right exposure minus left exposure
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  /// 1/s, sensitivity to the time offset: error of the estimate (a perturbation on the right) per second by
  /// which the right cameras of all pairs were exposed later than `offset` says.
  Vector6d dpose_doffset = Vector6d::Zero();
  /// Blend of motionByPoses() with the rows of rolling shutters; empty with global shutters.
  std::optional<MotionBlend> rows = std::nullopt;
};

/// Poses of a window, oldest first.
using TimedPoses = FixedVector<TimedPose, kMaximumWindowPairs>;

/// The right camera at its own exposure. The rig is assumed to move on a parabola through the poses of its
/// pair, of a neighbour and of a third pair, translation and rotation separately; without a third one, on a
/// line. With TimedPose::rows, on what the
/// rows make of the parabola.
struct RightCamera {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< rectified right camera
  int neighbour = -1;  ///< index of the neighbour's pose, see rightCameraOf(); -1: none
  int third = -1;      ///< index of the third pose; -1: none
  /// Jacobians of a perturbation of this camera (on the right) by those of its own pair and of the others.
  Matrix6d by_own = Matrix6d::Identity();
  Matrix6d by_neighbour = Matrix6d::Zero();
  Matrix6d by_third = Matrix6d::Zero();
  /// Jacobian by the offset, per s; defined at an offset of zero too, if there is another pose.
  Vector6d by_offset = Vector6d::Zero();
};

/// T_left_right of the rig: the right camera lies `baseline` (m) along the left one's x axis.
Eigen::Isometry3d leftFromRight(double baseline);

/// The right camera of poses[index]. The neighbour is the pair on the other side of the right exposure if
/// there is one (interpolation), else the pair on this side (extrapolation). The third is the pair on this
/// pair's other side, else the one beyond the neighbour.
RightCamera rightCameraOf(std::span<const TimedPose> poses, int index, double baseline);

/// Times (s, relative to poses[index]) of the other two poses of the parabola of rightCameraOf(); 0 where
/// there is none.
struct ParabolaTimes {
  double near = 0.0, far = 0.0;
};
ParabolaTimes parabolaTimes(std::span<const TimedPose> poses, int index);

/// Velocity and acceleration at poses[index] of the polynomial through poses[first] to poses[last], which
/// include it.
ExposureMotion motionByPolynomial(std::span<const TimedPose> poses, int index, int first, int last);

/// Motion about the exposure of poses[index]: the parabola of rightCameraOf(), or the line; none with a
/// single pose. Without TimedPose::rows.
ExposureMotion motionByPoses(std::span<const TimedPose> poses, int index);

/// Transform of points from the last pose's left camera to its right one, each at its own exposure.
Eigen::Isometry3d newestRightFromLeft(std::span<const TimedPose> poses, double baseline);

/// Right Jacobian of SO(3) at a rotation vector (T. Barfoot, "State Estimation for Robotics", 2017, eq. 7.77,
/// 7.78).
Eigen::Matrix3d rightJacobianOfRotation(const Eigen::Vector3d& rotation);

constexpr double kNearestRay = 1e-3;  ///< smallest z of a ray: a landmark nearer than a thousandth of its
                                      ///< depth counts as behind the camera

/// Projection of a landmark into a camera at T_camera_anchor: y = R b + rho t, with its bearing b (z = 1) and
/// its inverse depth rho in the anchor camera. y is up to the scale rho, so that rho = 0 is a point at
/// infinity.
struct Projection {
  bool valid = false;                               ///< in front of the camera
  Eigen::Vector3d ray = Eigen::Vector3d::Zero();    ///< y
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< px
};
Projection projectLandmark(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_anchor,
                           const Eigen::Vector3d& bearing, double inverse_depth);

/// Derivatives of a projection's pixel.
struct ProjectionJacobians {
  Eigen::Matrix<double, 2, 6> by_camera = Eigen::Matrix<double, 2, 6>::Zero();  ///< perturbation on the right
  Eigen::Matrix<double, 2, 6> by_anchor = Eigen::Matrix<double, 2, 6>::Zero();  ///< perturbation on the right
  Eigen::Matrix<double, 2, 3> by_bearing = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Vector2d by_inverse_depth = Eigen::Vector2d::Zero();
};
ProjectionJacobians projectionJacobians(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_anchor,
                                        const Eigen::Vector3d& bearing, double inverse_depth,
                                        const Projection& projection);

/// Direction of a pixel, z = 1.
inline Eigen::Vector3d bearingOf(const StereoCamera& camera, const Eigen::Vector2d& pixel) {
  return {(pixel.x() - camera.cx) / camera.focal_length, (pixel.y() - camera.cy) / camera.focal_length, 1.0};
}

}  // namespace cartvo::vo
