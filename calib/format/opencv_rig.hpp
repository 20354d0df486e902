#pragma once

#include <filesystem>
#include <string>

#include "calib/model/rig.hpp"

namespace cartvo {
class StrictYaml;
}  // namespace cartvo

namespace cartvo::calib {

/// Parses an OpenCV FileStorage (YAML) with K1 D1 K2 D2 R T image_size, as cv::stereoCalibrate returns them:
/// R and T take the left camera's axes to the right's, and T must be in metres. With `fisheye_model: 1` (as
/// OpenCV's calibration sample writes it) the distortion is that of cv::fisheye. Other keys are ignored;
/// thin-prism and tilt coefficients must be zero. T_body_camera is forwardLookingMount(). The rig gets the
/// stem of `name` as its name; error messages name the file `name`. Throws std::runtime_error naming file,
/// line, key and what was expected.
Rig parseOpenCvRig(const StrictYaml& yaml, const std::filesystem::path& name);

/// The FileStorage text of a rig, without the mount. Throws std::invalid_argument if its cameras have
/// different lens models.
std::string openCvText(const Rig& rig);

}  // namespace cartvo::calib
