#pragma once

#include <filesystem>
#include <string>

#include "calib/rig.hpp"

namespace cartvo {

/// The two sensor.yaml of a EuRoC sequence: pinhole with radial-tangential (k1 k2 p1 p2) or equidistant (the
/// wide lens) distortion. T_BS maps a camera's axes to the sensor body's, so T_right_left = inverse(T_BS
/// right) * T_BS left; where the sensor's body is on a cart nobody knows, and T_body_camera is
/// forwardLookingMount(). Throws std::runtime_error naming file, line, key and what was expected.
Rig readEurocRig(const std::filesystem::path& left_sensor, const std::filesystem::path& right_sensor);

/// The sensor.yaml of a rig's cameras.
struct EurocText {
  std::string left, right;
};

/// Such files of a rig; the body of T_BS is the cart's. Throws std::invalid_argument for distortion that
/// radial-tangential cannot hold.
EurocText eurocText(const Rig& rig);

}  // namespace cartvo
