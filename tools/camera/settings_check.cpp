// Compares what two cameras are set to with what odometry needs.
#include "tools/camera/settings_check.hpp"

namespace cartvo {
namespace {

Finding findingOf(const Setting& setting, const CameraDocuments& camera) {
  const std::optional<std::string> value = valueOf(setting, camera);
  if (!value || !applies(setting, camera))
    return {setting, setting.is_required && !value ? Verdict::unknown : Verdict::not_reported,
            value.value_or("")};
  return {setting, fits(setting, *value) ? Verdict::good : Verdict::wrong, *value};
}

/// Marks settings that are good on both cameras, but not the same.
void compare(std::vector<Finding>& left, std::vector<Finding>& right, const OdometryNeeds& needs) {
  for (std::size_t i = 0; i < left.size(); ++i) {
    const bool comparable = left[i].setting.alike && !isSwitch(left[i].setting) &&
                            left[i].verdict == Verdict::good && right[i].verdict == Verdict::good;
    if (comparable && !alike(left[i].setting, left[i].value, right[i].value, needs))
      left[i].verdict = right[i].verdict = Verdict::unlike;
  }
}

}  // namespace

double frameRateOf(const OdometryNeeds& needs, const CameraPair& cameras) {
  return frameRateOf(needs, cameras[0] != nullptr ? *cameras[0] : *cameras[1]);
}

std::array<std::vector<Finding>, 2> checkCameras(const CameraPair& cameras, const OdometryNeeds& needs) {
  std::array<std::vector<Finding>, 2> findings;
  if (cameras[0] == nullptr && cameras[1] == nullptr) return findings;
  for (const Setting& setting : cameraSettings(needs, frameRateOf(needs, cameras)))
    for (std::size_t i = 0; i < cameras.size(); ++i)
      if (cameras[i] != nullptr) findings[i].push_back(findingOf(setting, *cameras[i]));
  if (cameras[0] != nullptr && cameras[1] != nullptr) compare(findings[0], findings[1], needs);
  return findings;
}

bool areSameCamera(const CameraPair& cameras) {
  if (cameras[0] == nullptr || cameras[1] == nullptr) return false;
  const std::string& serial_number = cameras[0]->identity.serial_number;
  return !serial_number.empty() && serial_number == cameras[1]->identity.serial_number;
}

std::vector<std::string> compareCameras(const CameraPair& cameras) {
  std::vector<std::string> differences;
  if (cameras[0] == nullptr || cameras[1] == nullptr) return differences;
  const CameraIdentity &left = cameras[0]->identity, &right = cameras[1]->identity;
  if (areSameCamera(cameras))
    differences.push_back("both addresses lead to one camera (serial number " + left.serial_number + ")");
  if (left.model != right.model) {
    differences.push_back("the models differ (" + left.model + ", " + right.model +
                          "): their readouts may differ, too; see cartvo-calibrate-readout(1)");
  } else if (left.firmware != right.firmware) {
    differences.push_back("the firmware differs (" + left.firmware + ", " + right.firmware +
                          "): settings of the same name may not do the same");
  }
  return differences;
}

}  // namespace cartvo
