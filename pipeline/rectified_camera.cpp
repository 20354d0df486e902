// Makes the odometry's camera from the rectification.
#include "pipeline/rectified_camera.hpp"

namespace cartvo::pipeline {

vo::StereoCamera stereoCamera(const calib::Rectification& rectification) {
  vo::StereoCamera camera;
  camera.focal_length = rectification.focal_length;
  camera.cx = rectification.cx;
  camera.cy = rectification.cy;
  camera.baseline = rectification.baseline;
  camera.width = rectification.size.width;
  camera.height = rectification.size.height;
  return camera;
}

}  // namespace cartvo::pipeline
