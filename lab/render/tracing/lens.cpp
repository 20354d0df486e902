// Brown's lens model, its inverse, and the rig of the simulated cart.
#include "lab/render/tracing/lens.hpp"

#include <cmath>

#include "common/units.hpp"

namespace cartvo::world {
namespace {

/// The distorted point on the plane z = 1 of an undistorted one.
Eigen::Vector2d distortNormalized(const calib::CameraModel& camera, const Eigen::Vector2d& p) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  const double r2 = p.squaredNorm();
  const double radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
  const double xy = p.x() * p.y();
  return {p.x() * radial + 2.0 * p1 * xy + p2 * (r2 + 2.0 * p.x() * p.x()),
          p.y() * radial + p1 * (r2 + 2.0 * p.y() * p.y()) + 2.0 * p2 * xy};
}

calib::CameraModel cameraLike(const WorldSettings& settings, double focal_factor,
                              const Eigen::Vector2d& centre_shift, const std::array<double, 8>& distortion) {
  // centre_shift is given for a sensor 680 px wide; other sizes scale it.
  const double scale = settings.image_size.width / 680.0;
  calib::CameraModel camera;
  camera.size = settings.image_size;
  camera.fx = settings.focal_length * focal_factor;
  camera.fy = camera.fx * 1.0008;
  camera.cx = 0.5 * (settings.image_size.width - 1) + centre_shift.x() * scale;
  camera.cy = 0.5 * (settings.image_size.height - 1) + centre_shift.y() * scale;
  camera.distortion = distortion;
  return camera;
}

}  // namespace

Eigen::Vector2d distort(const calib::CameraModel& camera, const Eigen::Vector2d& normalized) {
  const Eigen::Vector2d d = distortNormalized(camera, normalized);
  return {camera.fx * d.x() + camera.cx, camera.fy * d.y() + camera.cy};
}

Eigen::Vector2d undistort(const calib::CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d wanted((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
  Eigen::Vector2d p = wanted;
  constexpr double kDelta = 1e-6;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d error = distortNormalized(camera, p) - wanted;
    if (error.norm() < 1e-14) break;
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d delta = kDelta * Eigen::Vector2d::Unit(axis);
      jacobian.col(axis) =
          (distortNormalized(camera, p + delta) - distortNormalized(camera, p - delta)) / (2 * kDelta);
    }
    p -= jacobian.inverse() * error;
  }
  return p;
}

RayTable::RayTable(const calib::CameraModel& camera)
    : width_(camera.size.width + 1), height_(camera.size.height + 1) {
  corners_.reserve(static_cast<std::size_t>(width_) * height_);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      corners_.emplace_back(undistort(camera, Eigen::Vector2d(x - 0.5, y - 0.5)).cast<float>());
    }
  }
}

calib::Rig simulatedRig(const WorldSettings& settings) {
  calib::Rig rig;
  rig.name = "simulated golf cart";
  rig.left = cameraLike(settings, 1.0011, {5.3, -3.8}, {-0.302, 0.094, 0.0004, -0.0003, 0.0, 0.0, 0.0, 0.0});
  rig.right = cameraLike(settings, 0.9978, {-4.1, 2.6}, {-0.297, 0.089, -0.0005, 0.0004, 0.0, 0.0, 0.0, 0.0});

  rig.left.readout = settings.left_readout;
  rig.right.readout = settings.right_readout;

  // Left camera: on the roof's front edge, looking ahead and 7 degrees down.
  Eigen::Matrix3d forward;  // camera axes (x right, y down, z ahead) in body axes
  forward << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  rig.T_body_camera.linear() =
      (Eigen::AngleAxisd(0.3 * kRadiansPerDegree, Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(7.0 * kRadiansPerDegree, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(-0.2 * kRadiansPerDegree, Eigen::Vector3d::UnitX()) * Eigen::Quaterniond(forward))
          .toRotationMatrix();
  rig.T_body_camera.translation() = Eigen::Vector3d(1.55, 0.5 * settings.baseline, 1.9);

  const Eigen::Matrix3d R_right_left =
      (Eigen::AngleAxisd(0.35 * kRadiansPerDegree, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(-0.5 * kRadiansPerDegree, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.25 * kRadiansPerDegree, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Vector3d right_in_left = settings.baseline * Eigen::Vector3d(1.0, 0.008, -0.012).normalized();
  rig.T_right_left.linear() = R_right_left;
  rig.T_right_left.translation() = -R_right_left * right_in_left;
  return rig;
}

}  // namespace cartvo::world
