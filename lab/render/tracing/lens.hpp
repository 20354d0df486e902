#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "calib/model/rig.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// The pixel of a point on the plane z = 1, by the rational Brown model of cartvo::CameraModel.
Eigen::Vector2d distort(const calib::CameraModel& camera, const Eigen::Vector2d& normalized);

/// The point on the plane z = 1 of a pixel: inverse of distort() by Newton's method, error below 1e-10 px
/// within the image.
Eigen::Vector2d undistort(const calib::CameraModel& camera, const Eigen::Vector2d& pixel);

/// Table of a camera's ray directions: exact at pixel corners, bilinear in between (error below 1e-6 px).
class RayTable {
 public:
  explicit RayTable(const calib::CameraModel& camera);

  /// Intersection of the ray through (x, y) with the plane z = 1. Pixel centres are integers; valid up to
  /// half a pixel outside the image.
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

/// The rig of the simulated cart: two cameras on the roof with different lenses and imperfect alignment.
calib::Rig simulatedRig(const WorldSettings& settings);

}  // namespace cartvo::world
