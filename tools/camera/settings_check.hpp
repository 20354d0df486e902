#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/camera/camera_documents.hpp"
#include "tools/camera/camera_settings.hpp"

// Compares what two cameras are set to with what odometry needs.

namespace cartvo {

/// Judgement of a setting.
enum class Verdict : std::uint8_t {
  good,
  wrong,         ///< not as odometry needs it
  unlike,        ///< good, but not the same on both cameras
  unknown,       ///< the camera does not report a setting that it must have
  not_reported,  ///< the camera does not have the setting, or it does not count now
};

/// One setting of one camera.
struct Finding {
  Setting setting;
  Verdict verdict = Verdict::good;
  std::string value;  ///< printable; empty if the camera does not report it

  bool isGood() const { return verdict == Verdict::good || verdict == Verdict::not_reported; }
};

/// A camera of the pair; nothing if it is not looked at.
using CameraPair = std::array<const CameraDocuments*, 2>;

/// The frame rate that both cameras need, Hz; see frameRateOf.
double frameRateOf(const OdometryNeeds& needs, const CameraPair& cameras);

/// The findings of both cameras, in the order of `cameraSettings`; none of a camera that is missing. With
/// both cameras, settings that must be alike are compared.
std::array<std::vector<Finding>, 2> checkCameras(const CameraPair& cameras, const OdometryNeeds& needs);

/// Whether both are one camera, by their serial numbers.
bool areSameCamera(const CameraPair& cameras);

/// Differences of two cameras beside their settings that may matter, such as the model; empty if there are
/// none.
std::vector<std::string> compareCameras(const CameraPair& cameras);

}  // namespace cartvo
