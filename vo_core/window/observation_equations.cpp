// Projection of a landmark into both cameras of a pair, with derivatives.
#include "vo_core/window/observation_equations.hpp"

#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/geometry/rig_correction.hpp"

namespace cartvo::vo {
namespace {

using Vector23 = Eigen::Matrix<double, 2, 3>;

/// Derivative of the pixel of a ray by the ray.
Vector23 pixelByRay(const StereoCamera& camera, const Eigen::Vector3d& ray) {
  const double scale = camera.focal_length / ray.z();
  Vector23 by_ray;
  by_ray << scale, 0.0, -scale * ray.x() / ray.z(), 0.0, scale, -scale * ray.y() / ray.z();
  return by_ray;
}

/// Derivative of the corrected right pixel (px) by the states from kPitch on; the correction is linear in
/// them. `pixel`: px, as seen.
Eigen::Matrix<double, 2, kRigStates> correctionByRig(const StereoCamera& camera,
                                                     const Eigen::Vector2d& pixel) {
  Eigen::Matrix<double, 2, kRigStates> by_rig;
  const auto column = [&](int state) { return by_rig.col(state - kPitch); };
  const auto shift = [&](const RigCorrection& unit) -> Eigen::Vector2d {
    return correctedRight(camera, unit, pixel) - pixel;
  };
  column(kPitch) = shift({.pitch = 1.0});
  column(kYaw) = shift({.yaw = 1.0});
  column(kRoll) = shift({.roll = 1.0});
  column(kP2) = shift({.p2 = 1.0});
  const double x = (pixel.x() - camera.cx) / camera.focal_length;
  const double y = (pixel.y() - camera.cy) / camera.focal_length;
  column(kSkew) = Eigen::Vector2d(0.0, camera.focal_length * x * y);
  return by_rig;
}

/// A landmark's pixel in one camera, and its derivatives.
struct Seen {
  Eigen::Vector2d pixel;
  Vector23 by_position, by_turn, by_place;
  Eigen::Vector2d by_time;
};

/// The camera `baseline` (m) to the right of the left one, `after` seconds after `instant`. Nothing if the
/// landmark is not in front of it.
std::optional<Seen> see(const StereoCamera& camera, const Trajectory::Instant& instant, double after,
                        double baseline, const WindowLandmark& landmark) {
  const double inverse_depth = landmark.place.z();
  const Eigen::Vector3d bearing(landmark.place.x(), landmark.place.y(), 1.0);
  const Eigen::Matrix3d to_camera = instant.rotation.transpose();
  const Eigen::Matrix3d from_host = to_camera * landmark.T_world_host.linear();
  const Eigen::Vector3d velocity = to_camera * (instant.velocity + after * instant.acceleration);
  const Eigen::Vector3d moved =  // to the second order in `after`
      after * (instant.velocity + 0.5 * after * instant.acceleration);
  const Eigen::Vector3d rate = instant.rate + after * instant.angular_acceleration;
  const Eigen::Vector3d turn = after * (instant.rate + 0.5 * after * instant.angular_acceleration);
  const Eigen::Vector3d host = to_camera * (landmark.T_world_host.translation() - instant.position - moved);
  const Eigen::Vector3d at_instant = from_host * bearing + inverse_depth * host;
  const Eigen::Vector3d turned = turn.cross(at_instant);
  const Eigen::Vector3d ray = at_instant - turned + 0.5 * turn.cross(turned);
  const Eigen::Vector3d seen = ray - inverse_depth * baseline * Eigen::Vector3d::UnitX();
  if (seen.z() < kNearestRay) return std::nullopt;
  const Vector23 by_ray = pixelByRay(camera, seen);
  Seen result;
  result.pixel = project(camera, seen);
  result.by_position.noalias() = -inverse_depth * by_ray * to_camera;
  result.by_turn.noalias() = by_ray * skew(ray);
  result.by_place.leftCols<2>().noalias() = by_ray * from_host.leftCols<2>();
  result.by_place.col(2).noalias() = by_ray * (host - baseline * Eigen::Vector3d::UnitX());
  result.by_time.noalias() = by_ray * (-inverse_depth * velocity - rate.cross(ray));
  return result;
}

}  // namespace

std::optional<ObservationEquations> equationsOf(const WindowProblem& problem, const WindowBand& band,
                                                const WindowLandmark& landmark,
                                                const WindowObservation& observation, double scale) {
  const WindowNoise& noise = problem.noise[landmark.level];
  ObservationEquations equations;
  equations.by_state.setZero();
  equations.by_place.setZero();
  const auto left =
      see(problem.camera, band.left,
          problem.leftTime(observation.pair, observation.left_share) - band.left_time, 0.0, landmark);
  if (!left) return std::nullopt;
  equations.residual.head<2>() = observation.left - left->pixel;
  equations.precision.head<2>() =
      (scale * noise.left * observation.relative_noise).cwiseAbs2().cwiseInverse();
  equations.by_state.block<2, 1>(0, kRowLeftReadout) = observation.left_share * left->by_time;
  equations.by_state.block<2, 3>(0, kRowLeftPosition) = left->by_position;
  equations.by_state.block<2, 3>(0, kRowLeftTurn) = left->by_turn;
  equations.by_place.topRows<2>() = left->by_place;
  if (!observation.stereo) return equations;

  const auto right = see(problem.camera, band.right,
                         problem.rightTime(observation.pair, observation.right_share) - band.right_time,
                         problem.camera.baseline, landmark);
  if (!right) return std::nullopt;
  const Eigen::Matrix<double, 2, kRigStates> by_rig = correctionByRig(problem.camera, observation.right);
  equations.residual.tail<2>() =
      observation.right + by_rig * problem.shared.tail<kRigStates>() - right->pixel;
  equations.precision.tail<2>() =
      (scale * noise.right * observation.relative_noise).cwiseAbs2().cwiseInverse();
  equations.by_state.block<2, 1>(2, kRowRightReadout) = observation.right_share * right->by_time;
  equations.by_state.block<2, 1>(2, kRowOffset) = right->by_time;
  equations.by_state.block<2, 3>(2, kRowRightPosition) = right->by_position;
  equations.by_state.block<2, 3>(2, kRowRightTurn) = right->by_turn;
  equations.by_state.block<2, kRigStates>(2, kRowRig) = -by_rig;
  equations.by_place.bottomRows<2>() = right->by_place;
  equations.residual.tail<2>() -= noise.common * equations.residual.head<2>();
  equations.by_state.bottomRows<2>() -= noise.common * equations.by_state.topRows<2>();
  equations.by_place.bottomRows<2>() -= noise.common * equations.by_place.topRows<2>();
  return equations;
}

}  // namespace cartvo::vo
