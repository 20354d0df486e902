#pragma once

#include <filesystem>
#include <string>

#include "calib/rig.hpp"

namespace cartvo {

class StrictYaml;

/// OpenCV FileStorage (YAML) with K1 D1 K2 D2 R T image_size, as cv::stereoCalibrate gives them: R and T map
/// the left camera's axes to the right's. T must be in metres. With `fisheye_model: 1` (as OpenCV's
/// calibration sample writes it) the distortion is that of cv::fisheye. Other keys are let pass; thin-prism
/// and tilt coefficients must be zero. The format does not know the cart: T_body_camera is
/// forwardLookingMount(). Throws std::runtime_error naming file, line, key and what was expected.
Rig readOpenCvRig(const std::filesystem::path& file);

/// The same of a file that is read already; `name` gives the rig its name and stands for the file in errors.
Rig openCvRig(const StrictYaml& yaml, const std::filesystem::path& name);

/// Such a file of a rig. Its mount is left out.
std::string openCvText(const Rig& rig);

}  // namespace cartvo
