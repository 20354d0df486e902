// Calibration models: names, free parameters and parameter names.
#include "calib/solver/calibration_model.hpp"

#include <array>

namespace cartvo::calib {
namespace {

constexpr std::array kBrownNames{"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
constexpr std::array kWideNames{"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4", "", "", "", ""};

}  // namespace

std::string modelName(CalibrationModel model) {
  switch (model) {
    case CalibrationModel::brown2:
      return "brown2";
    case CalibrationModel::brown4:
      return "brown4";
    case CalibrationModel::brown5:
      return "brown5";
    case CalibrationModel::brown8:
      return "brown8";
    case CalibrationModel::wide:
      break;
  }
  return "wide";
}

LensModel lensOf(CalibrationModel model) {
  return model == CalibrationModel::wide ? LensModel::wide : LensModel::brown;
}

std::vector<int> freeCameraParameters(CalibrationModel model) {
  switch (model) {
    case CalibrationModel::brown2:
      return {0, 1, 2, 3, 4, 5};
    case CalibrationModel::brown4:
      return {0, 1, 2, 3, 4, 5, 6, 7};
    case CalibrationModel::brown5:
      return {0, 1, 2, 3, 4, 5, 6, 7, 8};
    case CalibrationModel::brown8:
      return {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    case CalibrationModel::wide:
      break;
  }
  return {0, 1, 2, 3, 4, 5, 6, 7};
}

std::vector<int> freeRigParameters(CalibrationModel model) {
  const std::vector<int> camera = freeCameraParameters(model);
  std::vector<int> rig = camera;
  for (const int parameter : camera)
    rig.push_back(kRightCamera + parameter);
  for (int parameter = kRelativeRotation; parameter < kRigParameters; ++parameter)
    rig.push_back(parameter);
  return rig;
}

ParameterName parameterName(int rig_parameter, LensModel lens) {
  constexpr std::array kAxes{"x", "y", "z"};
  if (rig_parameter >= kRelativeTranslation) {
    return {
        std::string("translation ") + kAxes[static_cast<std::size_t>(rig_parameter - kRelativeTranslation)],
        "m"};
  }
  if (rig_parameter >= kRelativeRotation) {
    return {std::string("rotation ") + kAxes[static_cast<std::size_t>(rig_parameter - kRelativeRotation)],
            "rad"};
  }
  const bool is_left = rig_parameter < kRightCamera;
  const int parameter = is_left ? rig_parameter : rig_parameter - kRightCamera;
  const char* const name =
      (lens == LensModel::wide ? kWideNames : kBrownNames)[static_cast<std::size_t>(parameter)];
  return {std::string(is_left ? "left " : "right ") + name, parameter < kDistortion ? "px" : ""};
}

}  // namespace cartvo::calib
