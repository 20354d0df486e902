#pragma once

#include <filesystem>

#include <opencv2/core/types.hpp>

#include "calib/rig.hpp"

namespace cartvo {

class StrictYaml;

// Rigs from other tools' files. None of these formats knows the cart: T_body_camera is forwardLookingMount().
// All throw std::runtime_error naming file, line, key and what was expected.

/// OpenCV FileStorage (YAML) with K1 D1 K2 D2 R T image_size, as cv::stereoCalibrate gives them: R and T map
/// the left camera's axes to the right's. T must be in metres. Other keys are let pass; thin-prism and tilt
/// coefficients must be zero.
Rig readOpenCvRig(const std::filesystem::path& file);

/// The same of a file that is read already; `name` gives the rig its name and stands for the file in errors.
Rig openCvRig(const StrictYaml& yaml, const std::filesystem::path& name);

/// The two sensor.yaml of a EuRoC sequence (pinhole, radial-tangential). T_BS maps a camera's axes to the
/// sensor body's, so T_right_left = inverse(T_BS right) * T_BS left.
Rig readEurocRig(const std::filesystem::path& left_sensor, const std::filesystem::path& right_sensor);

/// P0 and P1 of a KITTI odometry sequence's calib.txt: rectified already, P1(0,3) = -f * baseline. The file
/// does not hold the images' size.
Rig readKittiRig(const std::filesystem::path& calibration, cv::Size image_size);

}  // namespace cartvo
