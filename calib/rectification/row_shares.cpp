// Raw rows of rectified pixels, as shares of the readout.
#include "calib/rectification/row_shares.hpp"

#include <algorithm>

#include "calib/model/lens.hpp"

namespace cartvo::calib {
namespace {

int lastNode(int pixels, int step) {
  return std::max(1, (pixels - 1 + step - 1) / step);
}

RowShareGrid buildGrid(const CameraModel& camera, const Eigen::Matrix3d& R_rectified_camera,
                       const Rectification& rectification, int step) {
  const Lens lens(camera);
  const Eigen::Matrix3d R_camera_rectified = R_rectified_camera.transpose();
  const double rows = camera.size.height;
  const double largest = 0.5 + 2.0 * step / rows;
  const int last_column = lastNode(rectification.size.width, step);
  const int last_row = lastNode(rectification.size.height, step);
  RowShareGrid grid;
  grid.columns = last_column + 1;
  for (int row = 0; row <= last_row; ++row) {
    for (int column = 0; column <= last_column; ++column) {
      const Eigen::Vector3d ray((step * column - rectification.cx) / rectification.focal_length,
                                (step * row - rectification.cy) / rectification.focal_length, 1.0);
      const double raw_row = camera.fy * lens.distort(R_camera_rectified * ray).y + camera.cy;
      grid.nodes.push_back(static_cast<float>(std::clamp((raw_row + 0.5) / rows - 0.5, -largest, largest)));
    }
  }
  return grid;
}

}  // namespace

StereoRowShares rowShares(const Rig& rig, const Rectification& rectification, int step) {
  if (rectification.is_identity) return {};
  return {buildGrid(rig.left, rectification.R_rectified_left, rectification, step),
          buildGrid(rig.right, rectification.R_rectified_right, rectification, step)};
}

}  // namespace cartvo::calib
