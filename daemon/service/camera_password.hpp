#pragma once

#include <string>

#include "daemon/service/configuration.hpp"

namespace cartvo::daemon {

/// Reads a camera's password from its file or from $CREDENTIALS_DIRECTORY (systemd.exec(5), LoadCredential=).
/// Empty if the camera has no user name. Throws std::runtime_error as readPasswordFile does.
std::string readPassword(const CameraConfiguration& camera);

}  // namespace cartvo::daemon
