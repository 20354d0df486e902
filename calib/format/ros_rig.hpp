#pragma once

#include <filesystem>
#include <string>

#include "calib/model/rig.hpp"

namespace cartvo {
class StrictYaml;
}  // namespace cartvo

namespace cartvo::calib {

/// Whether a file is one camera's camera_info: of the calibrator, or a message of the topic.
bool isRosCamera(const StrictYaml& yaml);

/// Reads the two camera_info of a stereo pair in ROS: the calibrator's files, or messages as 'rostopic echo'
/// or 'ros2 topic echo' prints them (K D R P or k d r p). Distortion: plumb_bob, rational_polynomial or
/// equidistant (the wide lens). The relative pose follows from the rectification: R of each camera takes its
/// axes to the rectified ones, and the right P contains -f * baseline. T_body_camera is
/// forwardLookingMount(). Throws std::runtime_error naming file, line, key and what was expected.
Rig readRosRig(const std::filesystem::path& left_file, const std::filesystem::path& right_file);

/// The texts of the two cameras' files.
struct RosText {
  std::string left, right;
};

/// The camera_info files of a rig, with cartvo's rectification and without the mount. Throws
/// std::invalid_argument if the rig cannot be rectified.
RosText rosText(const Rig& rig);

}  // namespace cartvo::calib
