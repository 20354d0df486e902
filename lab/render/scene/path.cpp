// Closed cubic B-spline with arc-length parametrisation.
#include "lab/render/scene/path.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::world {
namespace {

constexpr int kSubdivision = 16;
constexpr double kControlSpacing = 2.5;  // m
constexpr int kSmoothingPasses = 3;

/// The polygon with each corner replaced by points on an arc of `radius`.
std::vector<Eigen::Vector2d> roundCorners(const std::vector<Eigen::Vector2d>& polygon, double radius) {
  std::vector<Eigen::Vector2d> line;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d& corner = polygon[i];
    const Eigen::Vector2d in = (corner - polygon[(i + n - 1) % n]).normalized();
    const Eigen::Vector2d out = (polygon[(i + 1) % n] - corner).normalized();
    const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
    const Eigen::Vector2d start = corner - in * radius * std::tan(0.5 * std::abs(turn));
    const double side = turn > 0.0 ? 1.0 : -1.0;
    const Eigen::Vector2d centre = start + side * radius * Eigen::Vector2d(-in.y(), in.x());
    const int steps = std::max(2, static_cast<int>(std::ceil(std::abs(turn) * radius / 0.5)));
    for (int k = 0; k <= steps; ++k) {
      line.emplace_back(centre + Eigen::Rotation2Dd(turn * k / steps) * (start - centre));
    }
  }
  return line;
}

/// Points at equal distances of about `spacing` along a closed line.
std::vector<Eigen::Vector2d> resample(const std::vector<Eigen::Vector2d>& line, double spacing) {
  double total = 0.0;
  for (std::size_t i = 0; i < line.size(); ++i)
    total += (line[(i + 1) % line.size()] - line[i]).norm();
  const int count = std::max(8, static_cast<int>(std::lround(total / spacing)));
  std::vector<Eigen::Vector2d> points;
  double walked = 0.0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector2d& a = line[i];
    const Eigen::Vector2d& b = line[(i + 1) % line.size()];
    const double edge = (b - a).norm();
    while (static_cast<int>(points.size()) < count) {
      const double wanted = total * static_cast<double>(points.size()) / count;
      if (wanted > walked + edge) break;
      points.emplace_back(a + (b - a) * ((wanted - walked) / std::max(edge, 1e-12)));
    }
    walked += edge;
  }
  return points;
}

}  // namespace

Path::Path(const std::vector<Eigen::Vector2d>& polygon, double radius)
    : control_(resample(roundCorners(polygon, radius), kControlSpacing)) {
  const std::size_t n = control_.size();
  for (int pass = 0; pass < kSmoothingPasses; ++pass) {
    std::vector<Eigen::Vector2d> smooth(n);
    for (std::size_t i = 0; i < n; ++i) {
      smooth[i] = 0.25 * control_[(i + n - 1) % n] + 0.5 * control_[i] + 0.25 * control_[(i + 1) % n];
    }
    control_ = smooth;
  }
  arc_length_.push_back(0.0);
  constexpr double kStep = 1.0 / kSubdivision;
  for (std::size_t k = 0; k < n * kSubdivision; ++k) {
    const double a = static_cast<double>(k) * kStep;  // Simpson's rule
    const double sum = derivative(a, 1).norm() + 4.0 * derivative(a + 0.5 * kStep, 1).norm() +
                       derivative(a + kStep, 1).norm();
    arc_length_.push_back(arc_length_.back() + sum * kStep / 6.0);
  }
}

Eigen::Vector2d Path::derivative(double parameter, int order) const {
  const auto n = static_cast<int>(control_.size());
  const double whole = std::floor(parameter);
  const double x = parameter - whole;
  const double y = 1.0 - x;
  const auto p = [&](int i) -> const Eigen::Vector2d& {
    return control_[((static_cast<int>(whole) + i) % n + n) % n];
  };
  if (order == 0) {
    return (y * y * y * p(-1) + (3 * x * x * x - 6 * x * x + 4) * p(0) +
            (3 * y * y * y - 6 * y * y + 4) * p(1) + x * x * x * p(2)) /
           6.0;
  }
  if (order == 1) {
    return 0.5 * (-y * y * p(-1) + (3 * x * x - 4 * x) * p(0) + (-3 * y * y + 4 * y) * p(1) + x * x * p(2));
  }
  return y * p(-1) + (3 * x - 2) * p(0) + (3 * y - 2) * p(1) + x * p(2);
}

PathPoint Path::at(double distance) const {
  const double within = distance - length() * std::floor(distance / length());
  const auto above = std::upper_bound(arc_length_.begin(), arc_length_.end() - 1, within);
  const auto k = static_cast<double>(std::max<std::ptrdiff_t>(above - arc_length_.begin() - 1, 0));
  const double start = k / kSubdivision;
  double parameter = start;
  // Newton's method on the arc length within the interval; Simpson's rule, as in the table.
  for (int i = 0; i < 4; ++i) {
    const double mid = 0.5 * (start + parameter);
    const double speed = derivative(parameter, 1).norm();
    const double walked =
        (derivative(start, 1).norm() + 4.0 * derivative(mid, 1).norm() + speed) * (parameter - start) / 6.0;
    parameter += (within - arc_length_[static_cast<std::size_t>(k)] - walked) / speed;
  }
  const Eigen::Vector2d d1 = derivative(parameter, 1);
  const Eigen::Vector2d d2 = derivative(parameter, 2);
  PathPoint point;
  point.position = derivative(parameter, 0);
  point.tangent = d1.normalized();
  point.curvature = (d1.x() * d2.y() - d1.y() * d2.x()) / std::pow(d1.norm(), 3);
  return point;
}

double Terrain::height(double x, double y) const {
  return relief * (0.55 * std::sin(0.043 * x + 0.017 * y + 0.4) +
                   0.45 * std::sin(-0.021 * x + 0.049 * y + 1.9) + 0.12 * std::sin(0.11 * x + 0.083 * y));
}

Eigen::Isometry3d groundPose(const Terrain& terrain, const PathPoint& point, double lateral,
                             double wheelbase) {
  constexpr double kHalfTrack = 0.45;
  const Eigen::Vector2d rear = point.beside(lateral);
  const Eigen::Vector2d forward = point.tangent;
  const Eigen::Vector2d leftward(-forward.y(), forward.x());
  const auto height = [&](const Eigen::Vector2d& p) { return terrain.height(p.x(), p.y()); };
  const double z = height(rear);
  const double climb = std::atan2(height(rear + wheelbase * forward) - z, wheelbase);
  const double lean = std::atan2(height(rear + kHalfTrack * leftward) - height(rear - kHalfTrack * leftward),
                                 2.0 * kHalfTrack);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(rear.x(), rear.y(), z);
  pose.linear() = (Eigen::AngleAxisd(std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(-climb, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(lean, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace cartvo::world
