// Checks of the masks.
#include "vo_core/stereo_masks.hpp"

#include <stdexcept>
#include <string>

namespace cartvo::vo {
namespace {

void validate(const cv::Mat& mask, const StereoCamera& camera, const char* name) {
  if (mask.empty()) return;
  if (mask.type() == CV_8UC1 && mask.cols == camera.width && mask.rows == camera.height) return;
  throw std::invalid_argument(std::string(name) + " mask is " + std::to_string(mask.cols) + "x" +
                              std::to_string(mask.rows) + " of OpenCV type " + std::to_string(mask.type()) +
                              ": expected " + std::to_string(camera.width) + "x" +
                              std::to_string(camera.height) + " of CV_8UC1");
}

}  // namespace

void validate(const StereoMasks& masks, const StereoCamera& camera) {
  validate(masks.left, camera, "left");
  validate(masks.right, camera, "right");
}

}  // namespace cartvo::vo
