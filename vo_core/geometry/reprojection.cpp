// Projections of landmarks into the left and right cameras, and their derivatives by poses and depths.
#include "vo_core/geometry/reprojection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cartvo::vo {
namespace {

constexpr double kSimultaneous = 1e-7;  // s, a smaller offset counts as none

/// Index of the pair to which the right camera of poses[index] is interpolated; -1 if there is none.
int neighbourOf(std::span<const TimedPose> poses, int index) {
  const int side = poses[index].offset > 0.0 ? 1 : -1;
  for (const int neighbour : {index + side, index - side})
    if (neighbour >= 0 && neighbour < static_cast<int>(poses.size())) return neighbour;
  return -1;
}

/// Index of the third pair: on the pair's side away from the neighbour, else beyond the neighbour; -1 if
/// there is none.
int thirdOf(std::span<const TimedPose> poses, int index, int neighbour) {
  const int side = neighbour - index;
  for (const int third : {index - side, neighbour + side})
    if (third >= 0 && third < static_cast<int>(poses.size())) return third;
  return -1;
}

Eigen::Matrix3d inverseRightJacobianOfRotation(const Eigen::Vector3d& rotation) {
  return rightJacobianOfRotation(rotation).inverse();
}

/// Share of the motion to another pose in the step from the left exposure to the right one.
struct MotionTerm {
  MotionTerm() = default;
  MotionTerm(const TimedPose& own, const TimedPose& other)
      : D(own.T_world_camera.inverse() * other.T_world_camera), vector(vectorFromMotion(D)) {}

  Matrix6d byOwn(const Matrix6d& to_right) const {
    Matrix6d vector_by_own = Matrix6d::Zero();
    vector_by_own.topLeftCorner<3, 3>() = -Eigen::Matrix3d::Identity();
    vector_by_own.topRightCorner<3, 3>() = skew(vector.head<3>());
    vector_by_own.bottomRightCorner<3, 3>() = -inverseRightJacobianOfRotation(-vector.tail<3>());
    return weighted(to_right) * vector_by_own;
  }
  Matrix6d byOther(const Matrix6d& to_right) const {
    Matrix6d vector_by_other = Matrix6d::Zero();
    vector_by_other.topLeftCorner<3, 3>() = D.linear();
    vector_by_other.bottomRightCorner<3, 3>() = inverseRightJacobianOfRotation(vector.tail<3>());
    return weighted(to_right) * vector_by_other;
  }
  Matrix6d weighted(const Matrix6d& to_right) const {
    return matrix ? Matrix6d(to_right * *matrix) : Matrix6d(weight * to_right);
  }

  Eigen::Isometry3d D;
  Vector6d vector;
  double weight = 0.0;
  double weight_by_offset = 0.0;  // 1/s
  // Derivatives of the parabola's velocity (1/s) and acceleration (1/s^2) at the exposure.
  double velocity_weight = 0.0, acceleration_weight = 0.0;
  std::optional<Matrix6d> matrix;  // with rows: instead of `weight`
};

/// Jacobian of the perturbation on the right of a step by the change of the step.
Matrix6d perturbationByStep(const Vector6d& step) {
  Matrix6d to_right = Matrix6d::Zero();
  to_right.topLeftCorner<3, 3>() = motionFromVector(step).linear().transpose();
  to_right.bottomRightCorner<3, 3>() = rightJacobianOfRotation(step.tail<3>());
  return to_right;
}

/// Interpolated motion from the left exposure of poses[index] to its right one.
class InterpolatedMotion {
 public:
  InterpolatedMotion(std::span<const TimedPose> poses, int index) {
    neighbour = neighbourOf(poses, index);
    if (neighbour < 0) return;
    const TimedPose& own = poses[index];
    third = thirdOf(poses, index, neighbour);
    const double to_neighbour = poses[neighbour].time - own.time;
    MotionTerm& near = terms_.emplace_back(own, poses[neighbour]);
    near.weight = own.offset / to_neighbour;
    near.weight_by_offset = near.velocity_weight = 1.0 / to_neighbour;
    if (third >= 0) {
      // Lagrange polynomials; that of the own pose, which is the origin, drops out.
      const double to_third = poses[third].time - own.time;
      near.weight *= (own.offset - to_third) / (to_neighbour - to_third);
      near.weight_by_offset *= (2.0 * own.offset - to_third) / (to_neighbour - to_third);
      const double square = to_third * (to_third - to_neighbour);
      MotionTerm far(own, poses[third]);
      far.weight = own.offset * (own.offset - to_neighbour) / square;
      far.weight_by_offset = (2.0 * own.offset - to_neighbour) / square;
      near.velocity_weight *= -to_third / (to_neighbour - to_third);
      near.acceleration_weight = 2.0 / (to_neighbour * (to_neighbour - to_third));
      far.velocity_weight = -to_neighbour / square;
      far.acceleration_weight = 2.0 / square;
      terms_.push_back(far);
    }
    Vector6d step_by_offset = Vector6d::Zero();
    if (own.rows) {
      step_by_offset = blendWithRows(*own.rows, own.offset);
    } else {
      for (const MotionTerm& term : terms_) {
        step_ += term.weight * term.vector;
        step_by_offset += term.weight_by_offset * term.vector;
      }
    }
    to_right_ = perturbationByStep(step_);
    by_offset = to_right_ * step_by_offset;
  }

  Eigen::Isometry3d motion() const { return motionFromVector(step_); }
  Matrix6d byOwn() const {
    Matrix6d by_own = adjoint(motion().inverse());
    for (const MotionTerm& term : terms_)
      by_own += term.byOwn(to_right_);
    return by_own;
  }
  Matrix6d byNeighbour() const { return terms_[0].byOther(to_right_); }
  Matrix6d byThird() const { return terms_[1].byOther(to_right_); }

  int neighbour = -1;
  int third = -1;
  Vector6d by_offset = Vector6d::Zero();

 private:
  /// Sets the step to that of the parabola and the rows together, `offset` seconds after the exposure.
  /// Returns its derivative by the offset.
  Vector6d blendWithRows(const MotionBlend& rows, double offset) {
    // The step is [offset, offset^2 / 2, offset^3 / 6] times velocity, acceleration and jerk, of which the
    // parabola expects the first two.
    using StepByMotion = Eigen::Matrix<double, 6, 12>;
    using Factors = std::array<double, 3>;
    const auto of_expected = [&](const Factors& by) -> StepByMotion {
      const auto share = rows.expected_share.leftCols<12>();
      StepByMotion step = by[0] * share.topRows<6>() + by[1] * share.middleRows<6>(6);
      step.bottomRows<3>() += by[2] * share.bottomRows<3>();
      return step;
    };
    const auto of_rows = [&](const Factors& by) -> Vector6d {
      Vector6d step = by[0] * rows.by_rows.head<6>() + by[1] * rows.by_rows.segment<6>(6);
      step.tail<3>() += by[2] * rows.by_rows.tail<3>();
      return step;
    };
    const double half_square = 0.5 * offset * offset;
    const Factors by_motion{offset, half_square, half_square * offset / 3.0};
    const Factors rate_by_motion{1.0, offset, half_square};
    const StepByMotion step = of_expected(by_motion), slope = of_expected(rate_by_motion);
    step_ = of_rows(by_motion);
    Vector6d by_offset_of_step = of_rows(rate_by_motion);
    for (MotionTerm& term : terms_) {
      const Matrix6d matrix =
          term.velocity_weight * step.leftCols<6>() + term.acceleration_weight * step.rightCols<6>();
      term.matrix = matrix;
      step_ += matrix * term.vector;
      by_offset_of_step +=
          (term.velocity_weight * slope.leftCols<6>() + term.acceleration_weight * slope.rightCols<6>()) *
          term.vector;
    }
    return by_offset_of_step;
  }

  FixedVector<MotionTerm, 2> terms_;
  Vector6d step_ = Vector6d::Zero();
  Matrix6d to_right_ = Matrix6d::Zero();
};

}  // namespace

Eigen::Isometry3d leftFromRight(double baseline) {
  Eigen::Isometry3d T_left_right = Eigen::Isometry3d::Identity();
  T_left_right.translation().x() = baseline;
  return T_left_right;
}

Eigen::Matrix3d rightJacobianOfRotation(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d W = skew(rotation);
  if (angle < 1e-5) return Eigen::Matrix3d::Identity() - 0.5 * W + W * W / 6.0;
  const double squared = angle * angle;
  return Eigen::Matrix3d::Identity() - (1.0 - std::cos(angle)) / squared * W +
         (angle - std::sin(angle)) / (squared * angle) * W * W;
}

RightCamera rightCameraOf(std::span<const TimedPose> poses, int index, double baseline) {
  const TimedPose& own = poses[index];
  RightCamera right;
  const Eigen::Isometry3d T_left_right = leftFromRight(baseline);
  // Carries perturbations from the rig's left camera at that instant to the right camera.
  const Matrix6d to_right = adjoint(T_left_right.inverse());
  const InterpolatedMotion interpolated(poses, index);
  right.by_offset = to_right * interpolated.by_offset;
  if (interpolated.neighbour < 0 || std::abs(own.offset) < kSimultaneous) {
    right.by_own = to_right;
    right.T_world_camera = own.T_world_camera * T_left_right;
    return right;
  }
  right.neighbour = interpolated.neighbour;
  right.third = interpolated.third;
  right.by_own = to_right * interpolated.byOwn();
  right.by_neighbour = to_right * interpolated.byNeighbour();
  if (right.third >= 0) right.by_third = to_right * interpolated.byThird();
  right.T_world_camera = own.T_world_camera * interpolated.motion() * T_left_right;
  return right;
}

ParabolaTimes parabolaTimes(std::span<const TimedPose> poses, int index) {
  const int neighbour = neighbourOf(poses, index);
  if (neighbour < 0) return {};
  const int third = thirdOf(poses, index, neighbour);
  const double own = poses[index].time;
  return {poses[neighbour].time - own, third < 0 ? 0.0 : poses[third].time - own};
}

ExposureMotion motionByPolynomial(std::span<const TimedPose> poses, int index, int first, int last) {
  ExposureMotion motion;
  const TimedPose& own = poses[index];
  for (int k = first; k <= last; ++k) {
    if (k == index) continue;
    // First and second derivative of the Lagrange polynomial of pose k at the own pose, its origin.
    const double time = poses[k].time - own.time;
    double scale = 1.0 / time, product = 1.0, sum = 0.0;
    for (int j = first; j <= last; ++j) {
      if (j == k || j == index) continue;
      const double other = poses[j].time - own.time;
      scale /= time - other;
      product *= -other;
      sum -= 1.0 / other;
    }
    const Vector6d step = vectorFromMotion(own.T_world_camera.inverse() * poses[k].T_world_camera);
    motion.velocity += scale * product * step;
    motion.acceleration += 2.0 * scale * product * sum * step;
  }
  return motion;
}

ExposureMotion motionByPoses(std::span<const TimedPose> poses, int index) {
  const int neighbour = neighbourOf(poses, index);
  if (neighbour < 0) return {};
  const int third = thirdOf(poses, index, neighbour);
  const auto [first, last] = std::minmax({index, neighbour, third < 0 ? index : third});
  return motionByPolynomial(poses, index, first, last);
}

Eigen::Isometry3d newestRightFromLeft(std::span<const TimedPose> poses, double baseline) {
  const RightCamera right = rightCameraOf(poses, static_cast<int>(poses.size()) - 1, baseline);
  return right.T_world_camera.inverse() * poses.back().T_world_camera;
}

Projection projectLandmark(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_anchor,
                           const Eigen::Vector3d& bearing, double inverse_depth) {
  Projection projection;
  projection.ray = T_camera_anchor.linear() * bearing + inverse_depth * T_camera_anchor.translation();
  if (!(projection.ray.z() > kNearestRay)) return projection;
  projection.valid = true;
  projection.pixel = project(camera, projection.ray);
  return projection;
}

ProjectionJacobians projectionJacobians(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_anchor,
                                        const Eigen::Vector3d& bearing, double inverse_depth,
                                        const Projection& projection) {
  const Eigen::Vector3d& y = projection.ray;
  const double scale = camera.focal_length / y.z();
  Eigen::Matrix<double, 2, 3> by_ray;
  by_ray << scale, 0.0, -scale * y.x() / y.z(), 0.0, scale, -scale * y.y() / y.z();

  ProjectionJacobians jacobians;
  jacobians.by_camera.leftCols<3>() = -inverse_depth * by_ray;
  jacobians.by_camera.rightCols<3>() = by_ray * skew(y);
  jacobians.by_bearing = by_ray * T_camera_anchor.linear();
  jacobians.by_anchor.leftCols<3>() = inverse_depth * jacobians.by_bearing;
  jacobians.by_anchor.rightCols<3>() = -jacobians.by_bearing * skew(bearing);
  jacobians.by_inverse_depth = by_ray * T_camera_anchor.translation();
  return jacobians;
}

}  // namespace cartvo::vo
