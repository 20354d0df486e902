// Reads a camera's password from the configured file or from systemd's credentials.

#include "daemon/service/camera_password.hpp"

#include <cstdlib>
#include <stdexcept>

#include "capture/rtsp/password_file.hpp"

namespace cartvo::daemon {
namespace {

std::filesystem::path credentialFile(const std::string& name) {
  const char* folder = std::getenv("CREDENTIALS_DIRECTORY");
  if (folder == nullptr) {
    throw std::runtime_error("password_credential '" + name +
                             "': $CREDENTIALS_DIRECTORY is not set; run cartvod as a systemd service with "
                             "LoadCredential=" +
                             name + ":FILE, or use password_file");
  }
  return std::filesystem::path(folder) / name;
}

}  // namespace

std::string readPassword(const CameraConfiguration& camera) {
  if (camera.username.empty()) return {};
  return capture::readPasswordFile(camera.password_file.empty() ? credentialFile(camera.password_credential)
                                                                : camera.password_file);
}

}  // namespace cartvo::daemon
