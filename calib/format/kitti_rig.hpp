#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"

namespace cartvo::calib {

/// Reads P0 and P1 of a KITTI odometry sequence's calib.txt. The images are rectified, and P1(0,3) = -f *
/// baseline. The file does not contain the image size. T_body_camera is forwardLookingMount(). Throws
/// std::runtime_error naming file, line and what was expected.
Rig readKittiRig(const std::filesystem::path& calibration, cv::Size image_size);

/// Whether calib.txt can represent a rig: no distortion, parallel axes, one focal length.
bool isKittiRig(const Rig& rig);

/// The text of calib.txt for a rig, without mount and image size. Throws std::invalid_argument unless
/// isKittiRig().
std::string kittiText(const Rig& rig);

}  // namespace cartvo::calib
