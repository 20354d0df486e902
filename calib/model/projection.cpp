// Projection of points with derivatives, for both lens models.
#include "calib/model/projection.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::calib {
namespace {

/// Distorted normalised coordinates, with derivatives.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix<double, 2, 3> J_point;
  Eigen::Matrix<double, 2, 8> J_distortion;
};

std::optional<Distorted> brown(const std::array<double, 8>& distortion, const Eigen::Vector3d& point) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = distortion;
  if (!(point.z() > 1e-6)) return std::nullopt;
  const double x = point.x() / point.z(), y = point.y() / point.z();
  const double r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const double numerator = 1.0 + k1 * r2 + k2 * r4 + k3 * r6;
  const double denominator = 1.0 + k4 * r2 + k5 * r4 + k6 * r6;
  if (!(denominator > 1e-6)) return std::nullopt;
  const double L = numerator / denominator;
  const double slope = ((k1 + 2.0 * k2 * r2 + 3.0 * k3 * r4) - L * (k4 + 2.0 * k5 * r2 + 3.0 * k6 * r4)) /
                       denominator;  // dL/dr2
  Distorted result;
  result.point << x * L + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
      y * L + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  Eigen::Matrix2d J_normalised;
  J_normalised(0, 0) = L + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x;
  J_normalised(1, 1) = L + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  J_normalised(0, 1) = J_normalised(1, 0) = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
  Eigen::Matrix<double, 2, 3> J_perspective;
  J_perspective << 1.0, 0.0, -x, 0.0, 1.0, -y;
  result.J_point = J_normalised * J_perspective / point.z();
  const Eigen::Vector2d radial = Eigen::Vector2d(x, y) / denominator;
  result.J_distortion << radial * r2, radial * r4, Eigen::Vector2d(2.0 * x * y, r2 + 2.0 * y * y),
      Eigen::Vector2d(r2 + 2.0 * x * x, 2.0 * x * y), radial * r6, -L * radial * r2, -L * radial * r4,
      -L * radial * r6;
  return result;
}

std::optional<Distorted> wide(const std::array<double, 8>& distortion, const Eigen::Vector3d& point) {
  const double sideways = std::hypot(point.x(), point.y());
  const double length2 = point.squaredNorm();
  Distorted result;
  result.J_distortion.setZero();
  if (sideways < 1e-9 * std::sqrt(length2)) {
    if (!(point.z() > 0.0)) return std::nullopt;
    result.point = point.head<2>() / point.z();
    result.J_point << 1.0, 0.0, -result.point.x(), 0.0, 1.0, -result.point.y();
    result.J_point /= point.z();
    return result;
  }
  const double angle = std::atan2(sideways, point.z());
  const double a2 = angle * angle;
  double radius = angle, slope = 1.0, power = angle;  // angle^(2 i + 1)
  const Eigen::Vector2d direction = point.head<2>() / sideways;
  for (int i = 0; i < 4; ++i) {
    const double k = distortion[static_cast<std::size_t>(i)];
    slope += (2 * i + 3) * k * power * angle;
    power *= a2;
    radius += k * power;
    result.J_distortion.col(i) = power * direction;
  }
  result.point = radius * direction;
  const Eigen::RowVector3d angle_by_point(point.z() * direction.x() / length2,
                                          point.z() * direction.y() / length2, -sideways / length2);
  result.J_point = slope * direction * angle_by_point;
  result.J_point.leftCols<2>() +=
      radius / sideways * (Eigen::Matrix2d::Identity() - direction * direction.transpose());
  return result;
}

}  // namespace

CameraParameters parametersOf(const CameraModel& camera) {
  CameraParameters parameters;
  parameters << camera.fx, camera.fy, camera.cx, camera.cy,
      Eigen::Map<const Eigen::Matrix<double, 8, 1>>(camera.distortion.data());
  return parameters;
}

void setParameters(const CameraParameters& parameters, CameraModel& camera) {
  camera.fx = parameters[0];
  camera.fy = parameters[1];
  camera.cx = parameters[2];
  camera.cy = parameters[3];
  std::copy_n(parameters.data() + 4, camera.distortion.size(), camera.distortion.begin());
}

std::optional<LensProjection> project(const CameraModel& camera, const Eigen::Vector3d& point) {
  const std::optional<Distorted> distorted =
      camera.lens == LensModel::wide ? wide(camera.distortion, point) : brown(camera.distortion, point);
  if (!distorted) return std::nullopt;
  const Eigen::Vector2d focal_lengths(camera.fx, camera.fy);
  LensProjection projection;
  projection.pixel = focal_lengths.cwiseProduct(distorted->point) + Eigen::Vector2d(camera.cx, camera.cy);
  projection.J_point = focal_lengths.asDiagonal() * distorted->J_point;
  projection.J_camera << distorted->point.x(), 0.0, 1.0, 0.0,
      Eigen::Matrix<double, 1, 8>(camera.fx * distorted->J_distortion.row(0)), 0.0, distorted->point.y(), 0.0,
      1.0, Eigen::Matrix<double, 1, 8>(camera.fy * distorted->J_distortion.row(1));
  return projection;
}

}  // namespace cartvo::calib
