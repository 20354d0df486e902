#pragma once

#include <filesystem>
#include <string>

#include "calib/model/rig.hpp"

namespace cartvo {
class StrictYaml;
}  // namespace cartvo

namespace cartvo::calib {

/// Parses the first two cameras, left and right, of a Kalibr camchain.yaml: pinhole cameras with radtan (k1
/// k2 p1 p2), equidistant (the wide lens) or no distortion. T_cn_cnm1 takes the previous camera's axes to
/// this one's, so it is T_right_left; without it, T_cam_imu or OpenVINS' T_imu_cam of both cameras give it.
/// The rig gets the stem of `name` as its name; error messages name the file `name`. T_body_camera is
/// forwardLookingMount(). Throws std::runtime_error naming file, line, key and what was expected.
Rig parseKalibrRig(const StrictYaml& yaml, const std::filesystem::path& name);

/// The camchain.yaml of a rig, without the mount. Throws std::invalid_argument for distortion that radtan
/// cannot represent.
std::string kalibrText(const Rig& rig);

/// Reads the two sensor.yaml of a EuRoC sequence, or Kimera-VIO's LeftCameraParams.yaml and the right one:
/// pinhole cameras with radial-tangential (k1 k2 p1 p2) or equidistant (the wide lens) distortion. T_BS takes
/// a camera's axes to those of the sensor body, so T_right_left = inverse(right T_BS) * left T_BS.
/// T_body_camera is forwardLookingMount(), since the pose of the sensor body on the cart is not in the files.
/// Throws std::runtime_error naming file, line, key and what was expected.
Rig readEurocRig(const std::filesystem::path& left_sensor, const std::filesystem::path& right_sensor);

/// The texts of the two cameras' sensor.yaml.
struct EurocText {
  std::string left, right;
};

/// The sensor.yaml files of a rig; the body of T_BS is the cart. Throws std::invalid_argument for distortion
/// that radial-tangential cannot represent.
EurocText eurocText(const Rig& rig);

}  // namespace cartvo::calib
