#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace cartvo::calibrate {

/// The ground below a camera at an instant, in the axes of the rig's left camera.
struct GroundSighting {
  double seconds = 0.0;
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();  ///< unit normal
  double height = 0.0;                              ///< m
};

/// How a camera moved at an instant, in its own axes.
struct CameraTwist {
  double seconds = 0.0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< rad/s
};

/// A value and its standard deviation.
struct Measured {
  double value = 0.0;
  double deviation = 0.0;
};

/// How the left camera sits on the cart: R_body_camera = Rz(yaw) Ry(pitch) Rx(roll) of a camera that looks
/// forward. Angles in rad.
struct Mount {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  Measured height;              ///< above the ground, m
  Measured pitch;               ///< positive: looks down
  Measured roll;                ///< positive: its left side is higher
  std::optional<Measured> yaw;  ///< positive: looks to the left; nothing if the cart did not drive
  /// How far ahead of the point that moves without sideslip (a car's rear axle) the camera is, m; nothing if
  /// it did not drive in bends. Measured to tell bends from yaw, and not put into T_body_camera.
  std::optional<Measured> ahead_of_axle;
  int sightings = 0, motions = 0;  ///< that were used
};

/// Height, pitch and roll from the ground, as they are where nothing accelerates: a cart on springs pitches
/// with its forward acceleration and leans in bends, so pitch and roll are fitted as lines over these; yaw
/// from the direction of motion: the body's x axis is where the cart goes when it drives straight. In a bend
/// a camera that sits l ahead of the rear axle moves at the angle l omega / v to it, so angle = yaw + l omega
/// / v is fitted to all motions above 1 m/s. All fits are robust. Deviations are from the scatter of seconds,
/// for neighbouring pairs err together. What is not measured (position along and across, yaw without driving)
/// stays as in `T_body_camera`. Throws std::runtime_error if there are too few sightings.
Mount measureMount(const std::vector<GroundSighting>& sightings, const std::vector<CameraTwist>& motions,
                   const Eigen::Isometry3d& T_body_camera);

}  // namespace cartvo::calibrate
