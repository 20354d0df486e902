// Checks that the values of a rig describe two cameras of one rig.
#include "calib/model/rig_validation.hpp"

#include <stdexcept>
#include <string>

#include "calib/model/rotation.hpp"

namespace cartvo::calib {
namespace {

void validateCamera(const CameraModel& camera, const std::string& side) {
  const auto check = [&](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument("rig: the " + side + " camera's " + what);
  };
  check(camera.size.width >= 16 && camera.size.height >= 16, "image size is below 16x16 px");
  check(camera.size.width <= kMaxImageSide && camera.size.height <= kMaxImageSide,
        "image side is above 8192 px");
  for (const double focal_length : {camera.fx, camera.fy}) {
    check(focal_length >= kMinFocalLength && focal_length <= kMaxFocalLength,
          "focal lengths must lie in 1 to 100000 px");
  }
  const auto is_centre = [](double centre, int length) {
    return centre >= minCentre(length) && centre <= maxCentre(length);
  };
  check(is_centre(camera.cx, camera.size.width) && is_centre(camera.cy, camera.size.height),
        "principal point must lie within an image's size of the image");
  for (std::size_t i = 0; i < camera.distortion.size(); ++i) {
    check(std::isfinite(camera.distortion[i]), "distortion must be finite");
    check(i < distortionCount(camera.lens) || camera.distortion[i] == 0.0,
          "distortion has more coefficients than its lens model");
  }
}

}  // namespace

void validateRig(const Rig& rig) {
  validateCamera(rig.left, "left");
  validateCamera(rig.right, "right");
  if (rig.left.size != rig.right.size) {
    throw std::invalid_argument("rig: both cameras must have the same image size");
  }
  for (const Eigen::Isometry3d& transform : {rig.T_right_left, rig.T_body_camera}) {
    if (!isRotation(transform.linear())) throw std::invalid_argument("rig: a rotation is not orthonormal");
    if (!transform.translation().allFinite()) throw std::invalid_argument("rig: a translation is not finite");
  }
  if (!(rig.rectification.free_scaling >= 0.0 && rig.rectification.free_scaling <= 1.0)) {
    throw std::invalid_argument("rig: free_scaling must lie in 0 to 1");
  }
  if (!(rig.scale_stddev >= 0.0 && rig.scale_stddev <= kMaxScaleStddev)) {
    throw std::invalid_argument("rig: scale_deviation must lie in 0 to 0.1");
  }
  if (!(rig.baseline() >= kMinBaseline && rig.baseline() <= kMaxBaseline)) {
    throw std::invalid_argument("rig: the baseline is " + std::to_string(rig.baseline()) +
                                " m, expected 0.005 m to 10 m; was the board's square given in millimetres?");
  }
}

}  // namespace cartvo::calib
