#include "tools/calibrate/mount.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "calib/quantile.hpp"
#include "calib/rig.hpp"
#include "tools/calibrate/robust_line.hpp"

namespace cartvo::calibrate {
namespace {

/// The camera's attitude on the body, from what is up and what is forward in camera axes.
Eigen::Matrix3d bodyAxes(const Eigen::Vector3d& down, const Eigen::Vector3d& forward) {
  const Eigen::Vector3d up = -down.normalized();
  const Eigen::Vector3d ahead = (forward - up * up.dot(forward)).normalized();
  Eigen::Matrix3d R_body_camera;
  R_body_camera.row(0) = ahead;
  R_body_camera.row(1) = up.cross(ahead);
  R_body_camera.row(2) = up;
  return R_body_camera;
}

/// Yaw, pitch, roll of a camera against one that looks forward.
Eigen::Vector3d anglesOf(const Eigen::Matrix3d& R_body_camera) {
  const Eigen::Matrix3d R = R_body_camera * forwardLookingMount().linear().transpose();
  return {std::atan2(R(1, 0), R(0, 0)), -std::asin(std::clamp(R(2, 0), -1.0, 1.0)),
          std::atan2(R(2, 1), R(2, 2))};
}

/// The normal of all sightings, component by component.
Eigen::Vector3d medianDown(const std::vector<GroundSighting>& sightings) {
  Eigen::Vector3d down;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const GroundSighting& sighting : sightings)
      values.push_back(sighting.down[axis]);
    down[axis] = medianOf(values);
  }
  return down.normalized();
}

/// Yaw and position from the driving, on the ground's plane: the angle of the motion against the camera's
/// axis over the path's curvature, both positive to the left.
void measureCourse(const std::vector<CameraTwist>& motions, const Eigen::Vector3d& down, double known_ahead,
                   Mount& mount) {
  constexpr double kLeastSpeed = 1.0, kSharpest = 0.2;  // m/s; 1/m: a bend of 5 m
  constexpr std::size_t kFewest = 20;
  constexpr double kLeastSpread = 0.005;  // 1/m
  const Eigen::Matrix3d axes = bodyAxes(down, Eigen::Vector3d::UnitZ());
  std::vector<TimedSample> courses;
  for (const CameraTwist& motion : motions) {
    const Eigen::Vector3d velocity = axes * motion.velocity;
    if (std::abs(velocity.x()) < kLeastSpeed) continue;  // forward or backward
    const double curvature = (axes * motion.angular_velocity).z() / velocity.x();
    if (std::abs(curvature) > kSharpest) continue;
    courses.push_back({motion.seconds, curvature, std::atan(velocity.y() / velocity.x())});
  }
  if (courses.size() < kFewest) return;
  const RobustLine line = fitRobustLine(courses, known_ahead, kLeastSpread);
  mount.yaw = {-line.intercept, line.intercept_deviation};
  if (std::isfinite(line.slope_deviation)) mount.ahead_of_axle = {line.slope, line.slope_deviation};
  mount.motions = static_cast<int>(courses.size());
}

/// What leans a cart on its springs: acceleration, forward and to the left, m/s^2.
struct Accelerations {
  double forward = 0.0, left = 0.0;
};

/// From the motions within half a second: the slope of the speed, and speed times yaw rate. Zero where there
/// are too few.
Accelerations accelerationsAt(double seconds, const std::vector<CameraTwist>& motions,
                              const Eigen::Matrix3d& axes) {
  constexpr double kHalfWindow = 0.5;  // s
  constexpr int kFewest = 4;
  double count = 0.0, t1 = 0.0, t2 = 0.0, v1 = 0.0, tv = 0.0, left = 0.0;
  for (const CameraTwist& motion : motions) {
    const double t = motion.seconds - seconds;
    if (std::abs(t) > kHalfWindow) continue;
    const double speed = (axes * motion.velocity).x();
    count += 1.0;
    t1 += t;
    t2 += t * t;
    v1 += speed;
    tv += t * speed;
    left += speed * (axes * motion.angular_velocity).z();
  }
  if (count < kFewest) return {};
  return {(count * tv - t1 * v1) / (count * t2 - t1 * t1), left / count};
}

/// Height, pitch and roll: what they are where nothing accelerates.
void measureAttitude(const std::vector<GroundSighting>& sightings, const std::vector<CameraTwist>& motions,
                     const Eigen::Vector3d& down, const Eigen::Vector3d& forward, Mount& mount) {
  constexpr double kLeastSpread = 0.1, kAlways = 1e9;  // m/s^2
  const Eigen::Matrix3d axes = bodyAxes(down, forward);
  std::vector<TimedSample> heights, pitches, rolls;
  for (const GroundSighting& sighting : sightings) {
    const Accelerations acceleration = accelerationsAt(sighting.seconds, motions, axes);
    const Eigen::Vector3d angles = anglesOf(bodyAxes(sighting.down, forward));
    heights.push_back({sighting.seconds, 0.0, sighting.height});
    pitches.push_back({sighting.seconds, acceleration.forward, angles[1]});
    rolls.push_back({sighting.seconds, acceleration.left, angles[2]});
  }
  const RobustLine height = fitRobustLine(heights, 0.0, kAlways);
  const RobustLine pitch = fitRobustLine(pitches, 0.0, kLeastSpread);
  const RobustLine roll = fitRobustLine(rolls, 0.0, kLeastSpread);
  mount.height = {height.intercept, height.intercept_deviation};
  mount.pitch = {pitch.intercept, pitch.intercept_deviation};
  mount.roll = {roll.intercept, roll.intercept_deviation};
}

/// The camera's axis turned by a yaw against the direction of motion, or as it was known, in camera axes.
Eigen::Vector3d forwardOf(const Mount& mount, const Eigen::Vector3d& down,
                          const Eigen::Isometry3d& T_body_camera) {
  if (!mount.yaw) return T_body_camera.linear().row(0);
  const Eigen::Vector3d in_plane(std::cos(mount.yaw->value), -std::sin(mount.yaw->value), 0.0);
  return bodyAxes(down, Eigen::Vector3d::UnitZ()).transpose() * in_plane;
}

}  // namespace

Mount measureMount(const std::vector<GroundSighting>& sightings, const std::vector<CameraTwist>& motions,
                   const Eigen::Isometry3d& T_body_camera) {
  constexpr std::size_t kFewestSightings = 3;
  if (sightings.size() < kFewestSightings) {
    throw std::runtime_error(
        "the ground was seen in " + std::to_string(sightings.size()) +
        " pairs only: it must fill most of the lower half of the pictures, have texture, "
        "and the cart must stand while cameras that are not synchronised look at it");
  }
  const Eigen::Vector3d down = medianDown(sightings);
  Mount mount;
  mount.sightings = static_cast<int>(sightings.size());
  measureCourse(motions, down, T_body_camera.translation().x(), mount);
  const Eigen::Vector3d forward = forwardOf(mount, down, T_body_camera);
  measureAttitude(sightings, motions, down, forward, mount);
  const double yaw = anglesOf(bodyAxes(down, forward))[0];
  if (mount.yaw) mount.yaw->value = yaw;
  mount.T_body_camera = T_body_camera;
  mount.T_body_camera.translation().z() = mount.height.value;
  mount.T_body_camera.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(mount.pitch.value, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(mount.roll.value, Eigen::Vector3d::UnitX()) *
                                  Eigen::Quaterniond(forwardLookingMount().linear()))
                                     .toRotationMatrix();
  return mount;
}

}  // namespace cartvo::calibrate
