// Properties of camera models, and the default mount.
#include "calib/model/rig.hpp"

#include <algorithm>

namespace cartvo::calib {

std::size_t distortionCount(LensModel lens) {
  return lens == LensModel::wide ? 4 : 8;
}

bool isPinhole(const CameraModel& camera) {
  return camera.lens == LensModel::brown &&
         std::all_of(camera.distortion.begin(), camera.distortion.end(), [](double k) { return k == 0.0; });
}

bool hasMount(const Rig& rig) {
  return rig.T_body_camera.translation().z() != 0.0;
}

Eigen::Isometry3d forwardLookingMount() {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  // Columns: the camera's right, down and forward in body axes.
  T_body_camera.linear() << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,                       //
      0.0, -1.0, 0.0;
  return T_body_camera;
}

}  // namespace cartvo::calib
