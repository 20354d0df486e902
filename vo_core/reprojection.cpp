// Where landmarks are seen, and how that changes with poses and depths.
#include "vo_core/reprojection.hpp"

#include <cmath>
#include <optional>

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

/// On the pair's side away from the neighbour, else beyond the neighbour; -1 if there is none.
int thirdOf(const std::vector<TimedPose>& poses, int index, int neighbour) {
  const int side = neighbour - index;
  for (const int third : {index - side, neighbour + side})
    if (third >= 0 && third < static_cast<int>(poses.size())) return third;
  return -1;
}

Eigen::Matrix3d inverseRightJacobianOfRotation(const Eigen::Vector3d& rotation) {
  return rightJacobianOfRotation(rotation).inverse();
}

/// The share that the way to another pose has in the step from the left exposure to the right one.
struct WayShare {
  WayShare(const TimedPose& own, const TimedPose& other, double its_share)
      : D(own.T_world_camera.inverse() * other.T_world_camera), way(vectorFromMotion(D)), share(its_share) {}

  /// How a perturbation on the right of the step follows from the way's own change.
  Matrix6d toRight(const Vector6d& step) const {
    Matrix6d to_right = Matrix6d::Zero();
    to_right.topLeftCorner<3, 3>() = share * motionFromVector(step).linear().transpose();
    to_right.bottomRightCorner<3, 3>() = share * rightJacobianOfRotation(step.tail<3>());
    return to_right;
  }
  Matrix6d byOwn(const Vector6d& step) const {
    Matrix6d way_by_own = Matrix6d::Zero();
    way_by_own.topLeftCorner<3, 3>() = -Eigen::Matrix3d::Identity();
    way_by_own.topRightCorner<3, 3>() = skew(way.head<3>());
    way_by_own.bottomRightCorner<3, 3>() = -inverseRightJacobianOfRotation(-way.tail<3>());
    return toRight(step) * way_by_own;
  }
  Matrix6d byOther(const Vector6d& step) const {
    Matrix6d way_by_other = Matrix6d::Zero();
    way_by_other.topLeftCorner<3, 3>() = D.linear();
    way_by_other.bottomRightCorner<3, 3>() = inverseRightJacobianOfRotation(way.tail<3>());
    return toRight(step) * way_by_other;
  }

  Eigen::Isometry3d D;
  Vector6d way;
  double share;
};

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

  Eigen::Isometry3d carried = Eigen::Isometry3d::Identity();  // from the left exposure to the right one
  right.neighbour = std::abs(own.offset) < kSimultaneous ? -1 : neighbourOf(poses, index);
  if (right.neighbour >= 0) {
    right.third = thirdOf(poses, index, right.neighbour);
    const double to_neighbour = poses[right.neighbour].time - own.time;
    WayShare neighbour(own, poses[right.neighbour], own.offset / to_neighbour);
    std::optional<WayShare> third;
    Vector6d step = Vector6d::Zero();
    if (right.third >= 0) {
      // Lagrange's polynomial; that of the own pose, which is the origin, drops out.
      const double to_third = poses[right.third].time - own.time;
      neighbour.share *= (own.offset - to_third) / (to_neighbour - to_third);
      third.emplace(own, poses[right.third],
                    own.offset * (own.offset - to_neighbour) / (to_third * (to_third - to_neighbour)));
      step += third->share * third->way;
    }
    step += neighbour.share * neighbour.way;
    carried = motionFromVector(step);
    right.by_own = adjoint(carried.inverse()) + neighbour.byOwn(step);
    right.by_neighbour = neighbour.byOther(step);
    if (third) {
      right.by_own += third->byOwn(step);
      right.by_third = third->byOther(step);
    }
  }
  // From the rig's left camera at that instant to the right camera.
  const Matrix6d to_right = adjoint(T_left_right.inverse());
  right.by_own = to_right * right.by_own;
  right.by_neighbour = to_right * right.by_neighbour;
  right.by_third = to_right * right.by_third;
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
