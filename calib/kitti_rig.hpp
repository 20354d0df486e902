#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core/types.hpp>

#include "calib/rig.hpp"

namespace cartvo {

/// P0 and P1 of a KITTI odometry sequence's calib.txt: rectified already, P1(0,3) = -f * baseline. The file
/// does not hold the images' size. Throws std::runtime_error naming file, line and what was expected;
/// T_body_camera is forwardLookingMount().
Rig readKittiRig(const std::filesystem::path& calibration, cv::Size image_size);

/// Whether calib.txt can say what a rig is: no distortion, axes in parallel, one focal length.
bool isKittiRig(const Rig& rig);

/// Such a file of a rig, without its mount and image size. Throws std::invalid_argument unless isKittiRig().
std::string kittiText(const Rig& rig);

}  // namespace cartvo
