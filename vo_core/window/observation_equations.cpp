// Projection of a landmark into both cameras of a pair, with derivatives.
#include "vo_core/window/observation_equations.hpp"

#include "common/simd/target_clones.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/geometry/rig_correction.hpp"

namespace cartvo::vo {
namespace {

using Vector23 = Eigen::Matrix<double, 2, 3>;

/// Derivative of the corrected right pixel (px) by the states from kPitch on. `pixel`: correctedRight().
Eigen::Matrix<double, 2, kRigStates> correctionByRig(const StereoCamera& camera,
                                                     const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - camera.cx) / camera.focal_length;
  const double y = (pixel.y() - camera.cy) / camera.focal_length;
  Eigen::Matrix<double, 2, kRigStates> by_rig;
  by_rig << -x * y, 1.0 + x * x, -y, 3.0 * x * x + y * y, 0.0,  // of pitch, yaw, roll, p2, skew
      -1.0 - y * y, x * y, x, 2.0 * x * y, x * y;
  return camera.focal_length * by_rig;
}

/// A landmark's pixel in one camera, and its derivatives.
struct Seen {
  Eigen::Vector2d pixel;
  Vector23 by_position, by_turn, by_place;
  Eigen::Vector2d by_time;
};

/// The camera `baseline` (m) to the right of the left one, `after` seconds after `instant`. False if the
/// landmark is not in front of it.
inline bool see(const StereoCamera& camera, const Trajectory::Instant& instant, double after, double baseline,
                const WindowLandmark& landmark, Seen& seen) {
  const double inverse_depth = landmark.place.z();
  const Eigen::Vector3d bearing(landmark.place.x(), landmark.place.y(), 1.0);
  const auto host_axes = landmark.T_world_host.linear();
  const Eigen::Matrix3d to_camera = instant.rotation.transpose();
  const Eigen::Vector3d velocity = to_camera.lazyProduct(instant.velocity + after * instant.acceleration);
  const Eigen::Vector3d moved =  // to the second order in `after`
      after * (instant.velocity + 0.5 * after * instant.acceleration);
  const Eigen::Vector3d rate = instant.rate + after * instant.angular_acceleration;
  const Eigen::Vector3d turn = after * (instant.rate + 0.5 * after * instant.angular_acceleration);
  const Eigen::Vector3d host = landmark.T_world_host.translation() - instant.position - moved;
  const Eigen::Vector3d in_world = host_axes.lazyProduct(bearing) + inverse_depth * host;
  const Eigen::Vector3d at_instant = to_camera.lazyProduct(in_world);
  const Eigen::Vector3d turned = turn.cross(at_instant);
  const Eigen::Vector3d ray = at_instant - turned + 0.5 * turn.cross(turned);
  if (ray.z() < kNearestRay) return false;
  const double x = ray.x() - inverse_depth * baseline, by_z = 1.0 / ray.z(),
               scale = camera.focal_length * by_z;
  // Derivatives of the pixel by the ray are `scale` along the axis of the image, and these along the ray.
  const double along_x = -scale * x * by_z, along_y = -scale * ray.y() * by_z;
  seen.pixel = {camera.cx + scale * x, camera.cy + scale * ray.y()};
  const auto by_ray = [&](const Eigen::Vector3d& change) {
    return Eigen::Vector2d(scale * change.x() + along_x * change.z(),
                           scale * change.y() + along_y * change.z());
  };
  Vector23 by_world;
  for (int axis = 0; axis < 3; ++axis)
    by_world.col(axis) = by_ray(to_camera.col(axis));
  seen.by_position = -inverse_depth * by_world;
  seen.by_turn << along_x * -ray.y(), along_x * ray.x() - scale * ray.z(), scale * ray.y(),
      scale * ray.z() - along_y * ray.y(), along_y * ray.x(), -scale * ray.x();
  seen.by_place.leftCols<2>() = by_world.lazyProduct(host_axes.leftCols<2>());
  seen.by_place.col(2) = by_world.lazyProduct(host);
  seen.by_place(0, 2) -= scale * baseline;
  seen.by_time = by_ray(-inverse_depth * velocity - rate.cross(ray));
  return true;
}

}  // namespace

CARTVO_TARGET_CLONES
bool setEquations(const WindowProblem& problem, const WindowBand& band, const WindowLandmark& landmark,
                  const WindowObservation& observation, double scale, ObservationEquations& equations) {
  const WindowNoise& noise = problem.noise[landmark.level];
  equations.precision.setZero();
  equations.by_state.setZero();
  equations.by_place.setZero();
  Seen seen;
  const double left_after = problem.leftTime(observation.pair, observation.left_share) - band.left_time;
  if (!see(problem.camera, band.left, left_after, 0.0, landmark, seen)) return false;
  const auto precision_of = [&](double of_scale) {
    return (scale * of_scale * observation.relative_noise).cwiseAbs2().cwiseInverse();
  };
  equations.precision.head<2>() = precision_of(noise.left);
  equations.by_state.block<2, 3>(0, kRowLeftPosition) = seen.by_position;
  equations.by_state.block<2, 3>(0, kRowLeftTurn) = seen.by_turn;
  equations.by_state.block<2, 1>(0, kRowResidual) = observation.left - seen.pixel;
  // The instant of the row where the landmark is: a derivative by that of the row where it was seen would be
  // correlated with the residual.
  const auto predicted_share = [&](double share, double residual) {
    return share - residual / problem.camera.height;
  };
  equations.by_state.block<2, 1>(0, kRowLeftReadout) =
      predicted_share(observation.left_share, equations.by_state(1, kRowResidual)) * seen.by_time;
  equations.by_place.topRows<2>() = seen.by_place;
  if (!observation.stereo) return true;

  const double right_after = problem.rightTime(observation.pair, observation.right_share) - band.right_time;
  if (!see(problem.camera, band.right, right_after, problem.camera.baseline, landmark, seen)) return false;
  const SharedVector& shared = problem.shared;
  const Eigen::Vector2d corrected =
      correctedRight(problem.camera, {.yaw = shared[kYaw], .pitch = shared[kPitch], .roll = shared[kRoll]},
                     observation.right);
  const Eigen::Matrix<double, 2, kRigStates> by_rig = correctionByRig(problem.camera, corrected);
  equations.precision.tail<2>() = precision_of(noise.right);
  equations.by_state.block<2, 3>(2, kRowRightPosition) = seen.by_position;
  equations.by_state.block<2, 3>(2, kRowRightTurn) = seen.by_turn;
  equations.by_state.block<2, 1>(2, kRowOffset) = seen.by_time;
  equations.by_state.block<2, kRigStates>(2, kRowRig) = -by_rig;
  equations.by_state.block<2, 1>(2, kRowResidual) =
      corrected + by_rig.rightCols<kLensStates>().lazyProduct(shared.tail<kLensStates>()) - seen.pixel;
  equations.by_state.block<2, 1>(2, kRowRightReadout) =
      predicted_share(observation.right_share, equations.by_state(3, kRowResidual)) * seen.by_time;
  equations.by_place.bottomRows<2>() = seen.by_place;
  const auto take_common_off = [&](auto right, const auto& left) { right -= noise.common * left; };
  take_common_off(equations.by_state.block<2, kRowRightPosition>(2, 0),
                  equations.by_state.block<2, kRowRightPosition>(0, 0));
  take_common_off(equations.by_state.block<2, 1>(2, kRowResidual),
                  equations.by_state.block<2, 1>(0, kRowResidual));
  take_common_off(equations.by_place.bottomRows<2>(), equations.by_place.topRows<2>());
  return true;
}

}  // namespace cartvo::vo
