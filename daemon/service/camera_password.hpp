#pragma once

#include <string>

#include "daemon/service/configuration.hpp"

namespace cartvo::daemon {

/// Reads a camera's password from its file, or from the file that `password_credential` names: in
/// $CREDENTIALS_DIRECTORY (systemd.exec(5), LoadCredential=), else in the folder "credentials" beside the
/// configuration, from which the service gets it. Empty if the camera has no user name. Throws
/// std::runtime_error that names the places, and as readPasswordFile does.
std::string readPassword(const CameraConfiguration& camera);

}  // namespace cartvo::daemon
