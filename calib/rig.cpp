#include "calib/rig.hpp"

namespace cartvo {

Eigen::Isometry3d forwardLookingMount() {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  // Columns: the camera's right, down and forward as the body sees them.
  T_body_camera.linear() << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,                       //
      0.0, -1.0, 0.0;
  return T_body_camera;
}

}  // namespace cartvo
