#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/projection.hpp"
#include "calib/model/rig.hpp"

namespace cartvo::calib {

/// The distortion coefficients that are estimated for each camera, besides focal lengths and principal point.
enum class CalibrationModel : std::uint8_t {
  brown2,  ///< k1 k2, the model of the thesis
  brown4,  ///< k1 k2 p1 p2, which Kalibr, EuRoC and ROS call radtan or plumb bob
  brown5,  ///< k1 k2 p1 p2 k3
  brown8,  ///< k1 k2 p1 p2 k3 k4 k5 k6
  wide,    ///< Kannala and Brandt's k1 k2 k3 k4
};

std::string modelName(CalibrationModel model);
LensModel lensOf(CalibrationModel model);

// Order of a rig's parameters: those of the left camera, of the right camera, a small rotation vector applied
// to T_right_left from the left (rad), its translation (m).
inline constexpr int kRightCamera = kCameraParameters;
inline constexpr int kRelativeRotation = 2 * kCameraParameters;
inline constexpr int kRelativeTranslation = kRelativeRotation + 3;
inline constexpr int kRigParameters = kRelativeTranslation + 3;

/// Indices of the parameters of one camera that are free in a model.
std::vector<int> freeCameraParameters(CalibrationModel model);

/// Indices of the free parameters of the whole rig: both cameras and their relative pose.
std::vector<int> freeRigParameters(CalibrationModel model);

/// A parameter's name for display, such as "left fx" or "translation x", and its unit.
struct ParameterName {
  std::string name, unit;
};
ParameterName parameterName(int rig_parameter, LensModel lens);

}  // namespace cartvo::calib
