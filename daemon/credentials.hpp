#pragma once

#include <string>

#include "daemon/configuration.hpp"

namespace cartvo {

/// A camera's password, from its file or from $CREDENTIALS_DIRECTORY (systemd.exec(5), LoadCredential=),
/// without the line's end; empty if the camera has none. Throws std::runtime_error naming the file if it is
/// missing, empty, larger than 1 KiB, or if other users may read it.
std::string readPassword(const CameraConfiguration& camera);

}  // namespace cartvo
