// Height of the ground and poses on it.
#include "lab/render/scene/terrain.hpp"

#include <cmath>

namespace cartvo::world {

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
