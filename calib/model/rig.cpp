// Properties of camera models, their masks, and the default mount.
#include "calib/model/rig.hpp"

#include <algorithm>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace cartvo::calib {

double maskedShare(const StaticMask& mask) {
  if (mask.empty()) return 0.0;
  return 1.0 - static_cast<double>(cv::countNonZero(mask.used)) / static_cast<double>(mask.used.total());
}

StaticMask maskOfPart(const StaticMask& mask, const cv::Rect& part) {
  StaticMask cut;
  if (!mask.empty()) cut.used = mask.used(part).clone();
  return cut;
}

StaticMask maskOfPolygons(std::vector<StaticMask::Polygon> polygons, cv::Size size) {
  StaticMask mask;
  mask.used = cv::Mat(size, CV_8UC1, cv::Scalar(255));
  for (const StaticMask::Polygon& polygon : polygons)
    cv::fillPoly(mask.used, std::vector<StaticMask::Polygon>{polygon}, cv::Scalar(0));
  mask.polygons = std::move(polygons);
  return mask;
}

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
