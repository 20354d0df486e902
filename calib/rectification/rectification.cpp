// Computation of the rectification of a rig.
#include "calib/rectification/rectification.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "calib/model/lens.hpp"
#include "calib/model/rig_validation.hpp"

namespace cartvo::calib {
namespace {

/// An axis-aligned rectangle on the rectified image plane, in normalised coordinates.
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
    throw std::invalid_argument(
        "rig '" + rig.name +
        "': the right camera is not beside the left one; the translation of T_right_left "
        "must point along x");
  }
  if (right_in_left.x() < 0.0) {
    throw std::invalid_argument("rig '" + rig.name +
                                "': the right camera is to the left of the left one: the cameras are swapped "
                                "(exchange left and right), or T_right_left is inverted");
  }
}

/// The rotation by half the angle: the normalised sum of the quaternion and the identity.
Eigen::Quaterniond halfRotation(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  q.w() += 1.0;
  return q.normalized();
}

/// The smallest rotation that takes a unit vector, roughly along x, to x: Rodrigues' formula about the axis
/// (direction x e_x), with sine and cosine expressed by products.
Eigen::Matrix3d smallestRotationToX(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d axis = direction.cross(Eigen::Vector3d::UnitX());
  Eigen::Matrix3d K;
  K << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  return Eigen::Matrix3d::Identity() + K + K * K / (1.0 + direction.x());
}

/// Radius on the rectified plane at which the image of a wide lens is cut: the tangent of 70 degrees.
constexpr double kMaxRectifiedRadius = 2.747477419454622;

/// The intersection of a ray with the rectified plane. A ray beyond the radius, or from behind, is moved back
/// to it.
NormalisedPoint clampToMaxRadius(const Eigen::Vector3d& ray) {
  const double sideways = std::sqrt(ray.x() * ray.x() + ray.y() * ray.y());
  const double depth = std::max(ray.z(), sideways / kMaxRectifiedRadius);
  return {ray.x() / depth, ray.y() / depth};
}

/// The outline of the raw image on the rectified plane: the largest axis-aligned rectangle inside and the
/// smallest around it.
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
        is_wide ? clampToMaxRadius(ray) : NormalisedPoint{ray.x() / ray.z(), ray.y() / ray.z()};
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

/// Focal length and principal point (px) with which the image covers the rectangle: all of it if `fit` is
/// std::min, nothing beyond it if `fit` is std::max.
template <typename Fit>
Eigen::Vector3d pinholeOf(const Rectangle& rectangle, cv::Size size, Fit fit) {
  const double focal_length =
      fit((size.width - 1) / rectangle.width(), (size.height - 1) / rectangle.height());
  return {focal_length, (size.width - 1) / 2.0 - focal_length * (rectangle.left + rectangle.right) / 2.0,
          (size.height - 1) / 2.0 - focal_length * (rectangle.top + rectangle.bottom) / 2.0};
}

void chooseRectifiedCamera(const Rig& rig, const RectificationSettings& settings,
                           Rectification& rectification) {
  const auto [inner_l, outer_l] = rectifiedOutline(rig.left, rectification.R_rectified_left);
  const auto [inner_r, outer_r] = rectifiedOutline(rig.right, rectification.R_rectified_right);
  const Rectangle inner{std::max(inner_l.left, inner_r.left), std::max(inner_l.top, inner_r.top),
                        std::min(inner_l.right, inner_r.right), std::min(inner_l.bottom, inner_r.bottom)};
  const Rectangle outer{std::min(outer_l.left, outer_r.left), std::min(outer_l.top, outer_r.top),
                        std::max(outer_l.right, outer_r.right), std::max(outer_l.bottom, outer_r.bottom)};
  if (!(inner.width() > 0.0 && inner.height() > 0.0)) {
    throw std::invalid_argument("rig '" + rig.name +
                                "': the fields of view of the two cameras do not overlap");
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
  // Half of the relative rotation makes each camera parallel to the other; the second rotation aligns the
  // baseline with x.
  const Eigen::Quaterniond half = halfRotation(rig.T_right_left.linear());
  const Eigen::Vector3d right_in_left = rig.T_right_left.inverse().translation();
  const Eigen::Matrix3d to_baseline = smallestRotationToX((half * right_in_left).normalized());
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
  chooseRectifiedCamera(rig, settings, rectification);
  return rectification;
}

}  // namespace cartvo::calib
