#pragma once

#include <filesystem>
#include <string>

#include "calib/rig.hpp"

namespace cartvo {

class StrictYaml;

/// The first two cameras, left and right, of a Kalibr camchain.yaml: pinhole with radtan (k1 k2 p1 p2), none
/// or equidistant (the wide lens) distortion. T_cn_cnm1 takes the previous camera's axes to this one's: it is
/// T_right_left. `name` gives the rig its name and stands for the file in errors, which are
/// std::runtime_error; T_body_camera is forwardLookingMount().
Rig kalibrRig(const StrictYaml& yaml, const std::filesystem::path& name);

/// Such a file of a rig, without its mount. Throws std::invalid_argument for distortion that radtan cannot
/// hold.
std::string kalibrText(const Rig& rig);

}  // namespace cartvo
