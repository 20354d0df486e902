// Motion about another instant and of the rig's other camera.
#include "vo_core/geometry/exposure_motion.hpp"

namespace cartvo::vo {

MotionComponents componentsOf(const ExposureMotion& motion) {
  MotionComponents components;
  components << motion.velocity, motion.acceleration, motion.angular_jerk;
  return components;
}

ExposureMotion motionOf(const MotionComponents& components) {
  return {components.head<6>(), components.segment<6>(6), components.tail<3>()};
}

ExposureMotion motionAbout(const ExposureMotion& motion, double instant,
                           const Eigen::Isometry3d& T_camera_other, double range) {
  const Eigen::Isometry3d from = (motion.at(instant) * T_camera_other).inverse();
  const Vector6d after = vectorFromMotion(from * motion.at(instant + range) * T_camera_other);
  const Vector6d before = vectorFromMotion(from * motion.at(instant - range) * T_camera_other);
  // The jerk of the rotation alone is the same, in the other camera's axes.
  const Eigen::Vector3d angular_jerk = from.linear() * motion.angular_jerk;
  Vector6d velocity = (after - before) / (2.0 * range);
  velocity.tail<3>() -= range * range / 6.0 * angular_jerk;
  return {velocity, (after + before) / (range * range), angular_jerk};
}

}  // namespace cartvo::vo
