#pragma once

#include <opencv2/core/mat.hpp>

#include "vo_core/stereo_camera.hpp"

namespace cartvo::vo {

/// Pixels of the rectified images that never show the scene, such as the roof edge or lettering. Each is
/// CV_8UC1 of the camera's size: 0 where the image must not be used, any other value where it may; an empty
/// one uses all of its image.
struct StereoMasks {
  cv::Mat left, right;
};

/// Throws std::invalid_argument that names the first mask of another size or type.
void validate(const StereoMasks& masks, const StereoCamera& camera);

}  // namespace cartvo::vo
