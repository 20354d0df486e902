// Where landmarks are seen, and how that changes with poses and depths.
#include "vo_core/reprojection.hpp"

#include <cmath>

namespace cartvo {
namespace {

constexpr double kSimultaneous = 1e-7;  // s
constexpr double kNearestRay = 1e-3;  // of a ray's z: what is nearer than a thousandth of its depth is behind

/// The pair that the right camera of poses[index] leans on; -1 if it is alone.
int neighbourOf(const std::vector<TimedPose>& poses, int index) {
  const int side = poses[index].offset > 0.0 ? 1 : -1;
  for (const int neighbour : {index + side, index - side})
    if (neighbour >= 0 && neighbour < static_cast<int>(poses.size())) return neighbour;
  return -1;
}

Eigen::Matrix3d inverseRightJacobianOfRotation(const Eigen::Vector3d& rotation) {
  return rightJacobianOfRotation(rotation).inverse();
}

}  // namespace

Eigen::Matrix3d rightJacobianOfRotation(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d W = skew(rotation);
  if (angle < 1e-5) return Eigen::Matrix3d::Identity() - 0.5 * W + W * W / 6.0;
  const double squared = angle * angle;
  return Eigen::Matrix3d::Identity() - (1.0 - std::cos(angle)) / squared * W +
         (angle - std::sin(angle)) / (squared * angle) * W * W;
}

RightCamera rightCameraOf(const std::vector<TimedPose>& poses, int index, double baseline) {
  const TimedPose& own = poses[index];
  RightCamera right;
  Eigen::Isometry3d T_left_right = Eigen::Isometry3d::Identity();
  T_left_right.translation().x() = baseline;

  right.neighbour = std::abs(own.offset) < kSimultaneous ? -1 : neighbourOf(poses, index);
  Eigen::Isometry3d carried = Eigen::Isometry3d::Identity();  // from the left exposure to the right one
  if (right.neighbour >= 0) {
    const TimedPose& other = poses[right.neighbour];
    const double part = own.offset / (other.time - own.time);
    const Eigen::Isometry3d D = own.T_world_camera.inverse() * other.T_world_camera;
    const Vector6d step = vectorFromMotion(D);
    const Eigen::Vector3d turn = step.tail<3>();
    carried = motionFromVector(part * step);

    // The step's own change, carried to a perturbation on the right of what is interpolated.
    Matrix6d step_to_right = Matrix6d::Zero();
    step_to_right.topLeftCorner<3, 3>() = part * carried.linear().transpose();
    step_to_right.bottomRightCorner<3, 3>() = part * rightJacobianOfRotation(part * turn);
    Matrix6d step_by_own = Matrix6d::Zero();
    step_by_own.topLeftCorner<3, 3>() = -Eigen::Matrix3d::Identity();
    step_by_own.topRightCorner<3, 3>() = skew(step.head<3>());
    step_by_own.bottomRightCorner<3, 3>() = -inverseRightJacobianOfRotation(-turn);
    Matrix6d step_by_neighbour = Matrix6d::Zero();
    step_by_neighbour.topLeftCorner<3, 3>() = D.linear();
    step_by_neighbour.bottomRightCorner<3, 3>() = inverseRightJacobianOfRotation(turn);
    right.by_own = adjoint(carried.inverse()) + step_to_right * step_by_own;
    right.by_neighbour = step_to_right * step_by_neighbour;
  }
  // From the rig's left camera at that instant to the right camera.
  const Matrix6d to_right = adjoint(T_left_right.inverse());
  right.by_own = to_right * right.by_own;
  right.by_neighbour = to_right * right.by_neighbour;
  right.T_world_camera = own.T_world_camera * carried * T_left_right;
  return right;
}

Projection projectLandmark(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_host,
                           const Eigen::Vector3d& bearing, double inverse_depth) {
  Projection projection;
  projection.ray = T_camera_host.linear() * bearing + inverse_depth * T_camera_host.translation();
  if (!(projection.ray.z() > kNearestRay)) return projection;
  projection.valid = true;
  projection.pixel = project(camera, projection.ray);
  return projection;
}

ProjectionJacobians projectionJacobians(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_host,
                                        const Eigen::Vector3d& bearing, double inverse_depth,
                                        const Projection& projection) {
  const Eigen::Vector3d& y = projection.ray;
  const double scale = camera.focal_length / y.z();
  Eigen::Matrix<double, 2, 3> by_ray;
  by_ray << scale, 0.0, -scale * y.x() / y.z(), 0.0, scale, -scale * y.y() / y.z();

  ProjectionJacobians jacobians;
  jacobians.by_camera.leftCols<3>() = -inverse_depth * by_ray;
  jacobians.by_camera.rightCols<3>() = by_ray * skew(y);
  jacobians.by_bearing = by_ray * T_camera_host.linear();
  jacobians.by_host.leftCols<3>() = inverse_depth * jacobians.by_bearing;
  jacobians.by_host.rightCols<3>() = -jacobians.by_bearing * skew(bearing);
  jacobians.by_inverse_depth = by_ray * T_camera_host.translation();
  return jacobians;
}

}  // namespace cartvo
