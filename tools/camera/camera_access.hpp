#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/isapi/isapi_client.hpp"
#include "daemon/service/configuration.hpp"
#include "tools/camera/camera_documents.hpp"
#include "tools/camera/camera_settings.hpp"

// The configured cameras' ISAPI.

namespace cartvo {

/// How `cartvo camera` reaches the cameras.
struct AccessOptions {
  std::filesystem::path configuration = "/etc/cartvo/cartvod.yaml";
  std::string side = "both";     ///< left, right or both
  std::optional<int> http_port;  ///< default 80, with `https` 443
  bool https = false;
  std::filesystem::path known_cameras;  ///< empty: "known-cameras" beside the configuration
  std::optional<int> channel;           ///< for example 101; nothing: the one of the RTSP URL
  double timeout = 5.0;                 ///< s, of one request
};

/// A configured camera.
struct CameraAccess {
  std::string side;  ///< "left" or "right"
  CameraChannels channels;
  std::unique_ptr<capture::IsapiClient> client;
};

/// Opens the ISAPI of the cameras that the options name. With HTTPS the key of a camera that is met for the
/// first time is kept, before any password is sent, and reported to standard error. Throws as readPassword,
/// HttpConnection::fetchKey and KnownCameras do, and for a V4L2 camera, which has no ISAPI.
std::vector<CameraAccess> openCameras(const daemon::Configuration& configuration,
                                      const AccessOptions& options);

/// How to ask one camera without user and password; with HTTPS the key is kept as by openCameras. Throws as
/// HttpConnection::fetchKey and KnownCameras do.
capture::IsapiSettings withoutLogin(const daemon::CameraConfiguration& camera, const AccessOptions& options);

/// Adds the addresses of this computer, as the configured cameras see it. Adds none if they cannot be listed.
void addThisComputer(OdometryNeeds& needs, const daemon::Configuration& configuration);

/// Properties that the configuration and its rig file require of the cameras. Without a rig file any
/// picture size is accepted.
OdometryNeeds needsOf(const daemon::Configuration& configuration);

}  // namespace cartvo
