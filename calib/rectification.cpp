#include "calib/rectification.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "calib/lens.hpp"
#include "calib/rig_file.hpp"

namespace cartvo {
namespace {

/// An upright rectangle on the rectified image plane, normalised coordinates.
struct Rectangle {
  double left, top, right, bottom;
  double width() const { return right - left; }
  double height() const { return bottom - top; }
};

bool isRectified(const Rig& rig) {
  const CameraModel &left = rig.left, &right = rig.right;
  const Eigen::Vector3d t = rig.T_right_left.translation();
  return left.fx == left.fy && left.fx == right.fx && right.fx == right.fy && left.cx == right.cx &&
         left.cy == right.cy && isPinhole(left) && isPinhole(right) &&
         rig.T_right_left.linear() == Eigen::Matrix3d::Identity() && t.y() == 0.0 && t.z() == 0.0;
}

void checkBaseline(const Rig& rig) {
  const Eigen::Vector3d right_in_left = rig.T_right_left.inverse().translation();
  const double sideways = std::abs(right_in_left.x());
  if (sideways < std::abs(right_in_left.y()) || sideways < std::abs(right_in_left.z())) {
    throw std::invalid_argument("rig '" + rig.name +
                                "': the right camera does not stand beside the left one; T_right_left's "
                                "translation must point along x");
  }
  if (right_in_left.x() < 0.0) {
    throw std::invalid_argument(
        "rig '" + rig.name +
        "': the right camera stands to the left of the left one: the cameras are swapped "
        "(exchange left and right), or T_right_left is inverted");
  }
}

/// The rotation of half the angle: the normalised sum of the quaternion and the identity.
Eigen::Quaterniond halfRotation(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  q.w() += 1.0;
  return q.normalized();
}

/// The least rotation that takes a unit vector, which points about along x, to x: Rodrigues' formula for the
/// axis direction x e_x with its sine and cosine expressed by the products.
Eigen::Matrix3d leastRotationToX(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d axis = direction.cross(Eigen::Vector3d::UnitX());
  Eigen::Matrix3d K;
  K << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  return Eigen::Matrix3d::Identity() + K + K * K / (1.0 + direction.x());
}

/// The farthest from the rectified axis that a wide lens' image is kept: the tangent of 70 degrees.
constexpr double kWidestRadius = 2.747477419454622;

/// Where a ray meets the rectified plane; one that lies beyond the radius, or behind, is taken back to it.
NormalisedPoint withinWidest(const Eigen::Vector3d& ray) {
  const double sideways = std::sqrt(ray.x() * ray.x() + ray.y() * ray.y());
  const double depth = std::max(ray.z(), sideways / kWidestRadius);
  return {ray.x() / depth, ray.y() / depth};
}

/// What the outline of the raw image becomes on the rectified plane: the largest upright rectangle within and
/// the smallest around.
struct Outline {
  Rectangle inner, outer;
};

Outline rectifiedOutline(const CameraModel& camera, const Eigen::Matrix3d& R_rectified_camera) {
  const Lens lens(camera);
  const double right = camera.size.width - 1.0, bottom = camera.size.height - 1.0;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Outline outline{{-kInfinity, -kInfinity, kInfinity, kInfinity},
                  {kInfinity, kInfinity, -kInfinity, -kInfinity}};
  const auto rectified = [&](double column, double row) {
    const Eigen::Vector3d ray = R_rectified_camera * lens.undistort({(column - camera.cx) / camera.fx,
                                                                     (row - camera.cy) / camera.fy});
    const bool is_wide = camera.lens == LensModel::wide;
    if (!is_wide && !(ray.z() > 0.0))
      throw std::invalid_argument("the cameras are turned too far apart to be rectified");
    const NormalisedPoint point =
        is_wide ? withinWidest(ray) : NormalisedPoint{ray.x() / ray.z(), ray.y() / ray.z()};
    outline.outer.left = std::min(outline.outer.left, point.x);
    outline.outer.right = std::max(outline.outer.right, point.x);
    outline.outer.top = std::min(outline.outer.top, point.y);
    outline.outer.bottom = std::max(outline.outer.bottom, point.y);
    return point;
  };
  for (int row = 0; row < camera.size.height; ++row) {
    outline.inner.left = std::max(outline.inner.left, rectified(0.0, row).x);
    outline.inner.right = std::min(outline.inner.right, rectified(right, row).x);
  }
  for (int column = 0; column < camera.size.width; ++column) {
    outline.inner.top = std::max(outline.inner.top, rectified(column, 0.0).y);
    outline.inner.bottom = std::min(outline.inner.bottom, rectified(column, bottom).y);
  }
  return outline;
}

/// Focal length and principal point with which the image spans the rectangle: whole where `fit` is std::min,
/// and nothing beyond it where `fit` is std::max.
template <typename Fit>
Eigen::Vector3d pinholeOf(const Rectangle& rectangle, cv::Size size, Fit fit) {
  const double focal_length =
      fit((size.width - 1) / rectangle.width(), (size.height - 1) / rectangle.height());
  return {focal_length, (size.width - 1) / 2.0 - focal_length * (rectangle.left + rectangle.right) / 2.0,
          (size.height - 1) / 2.0 - focal_length * (rectangle.top + rectangle.bottom) / 2.0};
}

void chooseCamera(const Rig& rig, const RectificationSettings& settings, Rectification& rectification) {
  const auto [inner_l, outer_l] = rectifiedOutline(rig.left, rectification.R_rectified_left);
  const auto [inner_r, outer_r] = rectifiedOutline(rig.right, rectification.R_rectified_right);
  const Rectangle inner{std::max(inner_l.left, inner_r.left), std::max(inner_l.top, inner_r.top),
                        std::min(inner_l.right, inner_r.right), std::min(inner_l.bottom, inner_r.bottom)};
  const Rectangle outer{std::min(outer_l.left, outer_r.left), std::min(outer_l.top, outer_r.top),
                        std::max(outer_l.right, outer_r.right), std::max(outer_l.bottom, outer_r.bottom)};
  if (!(inner.width() > 0.0 && inner.height() > 0.0)) {
    throw std::invalid_argument("rig '" + rig.name + "': the two cameras have no view in common");
  }
  const auto larger = [](double a, double b) { return std::max(a, b); };
  const auto smaller = [](double a, double b) { return std::min(a, b); };
  const Eigen::Vector3d cropped = pinholeOf(inner, rectification.size, larger);
  const Eigen::Vector3d whole = pinholeOf(outer, rectification.size, smaller);
  const Eigen::Vector3d chosen = cropped + settings.free_scaling * (whole - cropped);
  rectification.focal_length = chosen[0];
  rectification.cx = chosen[1];
  rectification.cy = chosen[2];
}

}  // namespace

RectifyingRotations rectifyingRotations(const Rig& rig) {
  checkBaseline(rig);
  // Turned by half of the relative rotation each, the cameras are parallel; then the baseline is laid along
  // x.
  const Eigen::Quaterniond half = halfRotation(rig.T_right_left.linear());
  const Eigen::Vector3d right_in_left = rig.T_right_left.inverse().translation();
  const Eigen::Matrix3d to_baseline = leastRotationToX((half * right_in_left).normalized());
  return {to_baseline * half.toRotationMatrix(), to_baseline * half.conjugate().toRotationMatrix()};
}

Rectification computeRectification(const Rig& rig, const RectificationSettings& settings) {
  validateRig(rig);
  if (!(settings.free_scaling >= 0.0 && settings.free_scaling <= 1.0)) {
    throw std::invalid_argument("rectification: free_scaling must lie in 0 to 1");
  }
  checkBaseline(rig);
  Rectification rectification;
  rectification.size = rig.left.size;
  rectification.baseline = rig.baseline();
  if (isRectified(rig)) {
    rectification.focal_length = rig.left.fx;
    rectification.cx = rig.left.cx;
    rectification.cy = rig.left.cy;
    rectification.is_identity = true;
    return rectification;
  }
  const RectifyingRotations rotations = rectifyingRotations(rig);
  rectification.R_rectified_left = rotations.left;
  rectification.R_rectified_right = rotations.right;
  chooseCamera(rig, settings, rectification);
  return rectification;
}

}  // namespace cartvo
