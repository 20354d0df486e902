#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "calib/rig.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

/// From a point on the plane z = 1 to its pixel, by Brown's model as cartvo::CameraModel says.
Eigen::Vector2d distort(const CameraModel& camera, const Eigen::Vector2d& normalized);

/// The reverse, by Newton's method, to below 1e-10 px within the image.
Eigen::Vector2d undistort(const CameraModel& camera, const Eigen::Vector2d& pixel);

/// Where every ray of a camera goes: exact at the pixels' corners, linear in between (the error is below 1e-6
/// px).
class RayTable {
 public:
  explicit RayTable(const CameraModel& camera);

  /// The ray's meeting point with the plane z = 1; pixel centres at integers, valid half a pixel beyond the
  /// image.
  Eigen::Vector2f direction(float x, float y) const {
    const float gx = x + 0.5F;
    const float gy = y + 0.5F;
    const int ix = std::min(static_cast<int>(gx), width_ - 2);
    const int iy = std::min(static_cast<int>(gy), height_ - 2);
    const float fx = gx - static_cast<float>(ix);
    const float fy = gy - static_cast<float>(iy);
    const Eigen::Vector2f* corner = &corners_[static_cast<std::size_t>(iy) * width_ + ix];
    const Eigen::Vector2f upper = corner[0] + fx * (corner[1] - corner[0]);
    const Eigen::Vector2f lower = corner[width_] + fx * (corner[width_ + 1] - corner[width_]);
    return upper + fy * (lower - upper);
  }

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<Eigen::Vector2f> corners_;
};

/// The two cameras on the cart's roof: unlike each other and not quite straight, as real ones are.
Rig simulatedRig(const WorldSettings& settings);

}  // namespace cartvo::world
