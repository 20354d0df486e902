#pragma once

#include <filesystem>
#include <string>

#include "daemon/service/configuration.hpp"

namespace cartvo::daemon {

/// The file with a camera's password, or the file that `password_credential` names: in
/// $CREDENTIALS_DIRECTORY (systemd.exec(5), LoadCredential=), else in the folder "credentials" beside the
/// configuration, from which the service gets it. Throws std::runtime_error that names both places if a
/// credential is in neither.
std::filesystem::path passwordFile(const CameraConfiguration& camera);

/// Reads a camera's password from its file. Empty if the camera has no user name. Throws as passwordFile and
/// readPasswordFile do.
std::string readPassword(const CameraConfiguration& camera);

/// Reads the status page's token in the same way; empty if none is configured.
std::string readPageToken(const PageConfiguration& page);

}  // namespace cartvo::daemon
