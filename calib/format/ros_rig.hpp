#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

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

/// Whether a file is KITTI's calib.txt or calib_cam_to_cam.txt.
bool isKittiRig(const StrictYaml& yaml);

/// Parses the calibration of two of KITTI's cameras (0 and 1: grey, 2 and 3: colour):
/// - calib.txt of the odometry sequences: P0 to P3, of rectified images. The file does not contain their
/// size.
/// - calib_cam_to_cam.txt of the raw recordings: K, D, R, T and S of the raw images, P_rect and S_rect of the
///   rectified ones (A. Geiger et al., "Vision meets Robotics: The KITTI Dataset", IJRR 2013; R and T take a
///   point from camera 0 to the camera). The image size says which ones are meant.
/// The last column of a projection matrix is K times the camera's translation. T_body_camera is
/// forwardLookingMount(). Throws std::runtime_error naming file, line and what was expected.
Rig parseKittiRig(const StrictYaml& yaml, const std::filesystem::path& name,
                  std::optional<cv::Size> image_size, std::array<int, 2> cameras = {0, 1});

/// Whether calib.txt can represent a rig: no distortion, parallel axes, one focal length.
bool isKittiRig(const Rig& rig);

/// The text of calib.txt for a rig, without mount and image size. Throws std::invalid_argument unless
/// isKittiRig().
std::string kittiText(const Rig& rig);

}  // namespace cartvo::calib
