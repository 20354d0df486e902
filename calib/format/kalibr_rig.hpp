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

}  // namespace cartvo::calib
