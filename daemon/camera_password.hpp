#pragma once

#include <string>

#include "daemon/configuration.hpp"

namespace cartvo {

/// A camera's password, from its file or from $CREDENTIALS_DIRECTORY (systemd.exec(5), LoadCredential=);
/// empty if the camera has none. Throws std::runtime_error as readPasswordFile does.
std::string readPassword(const CameraConfiguration& camera);

}  // namespace cartvo
