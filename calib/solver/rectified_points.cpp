// Rectified coordinates of raw pixels, and the vertical disparities of board corners.
#include "calib/solver/rectified_points.hpp"

#include <stdexcept>

namespace cartvo::calib {

RectifiedPoints::RectifiedPoints(const Rig& rig)
    : left_(rig.left),
      right_(rig.right),
      left_lens_(rig.left),
      right_lens_(rig.right),
      rotations_(rectifyingRotations(rig)),
      focal_length_((rig.left.fx + rig.left.fy + rig.right.fx + rig.right.fy) / 4.0) {}

std::optional<Eigen::Vector2d> RectifiedPoints::rectify(const CameraModel& camera, const Lens& lens,
                                                        const Eigen::Matrix3d& rotation,
                                                        const Eigen::Vector2d& raw_pixel) const {
  const NormalisedPoint distorted{(raw_pixel.x() - camera.cx) / camera.fx,
                                  (raw_pixel.y() - camera.cy) / camera.fy};
  Eigen::Vector3d ray;
  try {
    ray = lens.undistort(distorted);
  } catch (const std::invalid_argument&) {  // beyond the radius where the distortion folds
    return std::nullopt;
  }
  ray = rotation * ray;
  constexpr double kMinCosine = 0.34;  // of 70 degrees: further out a plane stretches the image too much
  if (ray.z() < kMinCosine * ray.norm()) return std::nullopt;
  return Eigen::Vector2d(focal_length_ * ray.x() / ray.z(), focal_length_ * ray.y() / ray.z());
}

std::vector<double> verticalDisparities(const RectifiedPoints& rectified, const BoardView& view) {
  std::vector<double> disparities;
  auto right = view.right.begin();
  for (const SeenCorner& left : view.left) {
    while (right != view.right.end() && right->id < left.id)
      ++right;
    if (right == view.right.end() || right->id != left.id) continue;
    const auto in_left = rectified.rectifyLeft(left.pixel);
    const auto in_right = rectified.rectifyRight(right->pixel);
    if (in_left && in_right) disparities.push_back(in_left->y() - in_right->y());
  }
  return disparities;
}

}  // namespace cartvo::calib
