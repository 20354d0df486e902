#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace cartvo::calibrate {

/// The ground plane at an instant, in the axes of the rig's left camera.
struct GroundObservation {
  double seconds = 0.0;
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();  ///< unit normal, pointing away from the camera
  double height = 0.0;                              ///< of the camera above the ground, m
};

/// The twist of a camera at an instant, in its own axes.
struct CameraTwist {
  double seconds = 0.0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< rad/s
};

/// A value and its standard deviation.
struct Estimate {
  double value = 0.0;
  double stddev = 0.0;
};

/// The mount of the left camera on the cart: R_body_camera = Rz(yaw) Ry(pitch) Rx(roll) times that of a
/// camera that looks forward. Angles in rad.
struct Mount {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  Estimate height;              ///< above the ground, m
  Estimate pitch;               ///< positive: looks down
  Estimate roll;                ///< positive: the camera's left side is higher
  std::optional<Estimate> yaw;  ///< positive: looks to the left; std::nullopt if the cart did not drive
  /// Distance of the camera ahead of the point without sideslip (the rear axle of a car), m; std::nullopt if
  /// the cart did not drive curves. It is estimated to separate curves from yaw, and not stored in
  /// T_body_camera.
  std::optional<Estimate> ahead_of_axle;
  int ground_observations = 0, motions = 0;  ///< number of measurements used
};

/// Estimates the mount. Height, pitch and roll come from the ground: a cart on springs pitches with its
/// forward acceleration and rolls in curves, so pitch and roll are fitted as lines over these accelerations
/// and evaluated at zero. Yaw comes from the direction of motion: the body's x axis is the direction of
/// straight driving. In a curve, a camera that is l ahead of the rear axle moves at the angle l omega / v to
/// it, so angle = yaw + l omega / v is fitted to all motions above 1 m/s. All fits are robust. Standard
/// deviations come from the scatter between seconds, since the errors of neighbouring pairs are correlated.
/// Quantities that are not measured (x and y, and yaw without driving) stay as in `T_body_camera`. Throws
/// std::runtime_error if there are too few ground observations.
Mount measureMount(const std::vector<GroundObservation>& ground, const std::vector<CameraTwist>& motions,
                   const Eigen::Isometry3d& T_body_camera);

/// Time from the first to the last ground observation, s.
double durationOf(const std::vector<GroundObservation>& ground);

/// Adds to the standard deviations what the scatter within the drive does not show: the road under the wheels
/// tilts the cart by some tenths of a degree. Its slope along the drive averages over `seconds`, its slope to
/// the side does not. The values are from rendered drives, see cartvo-calibrate-mount(1).
Mount withRoadUncertainty(const Mount& mount, double seconds);

}  // namespace cartvo::calibrate
