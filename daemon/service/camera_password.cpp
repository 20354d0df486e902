// Reads a camera's password from the configured file or credential.

#include "daemon/service/camera_password.hpp"

#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include "capture/rtsp/password_file.hpp"

namespace cartvo::daemon {
namespace {

/// The file of a credential: in $CREDENTIALS_DIRECTORY, which systemd sets for the service, else in the
/// folder beside the configuration. Throws std::runtime_error that names both.
std::filesystem::path credentialFile(const CameraConfiguration& camera) {
  const char* given = std::getenv("CREDENTIALS_DIRECTORY");
  const std::string& name = camera.password_credential;
  std::filesystem::path beside = camera.credentials / name;
  std::error_code error;
  if (given != nullptr && std::filesystem::exists(std::filesystem::path(given) / name, error))
    return std::filesystem::path(given) / name;
  if (std::filesystem::exists(beside, error)) return beside;
  throw std::runtime_error(
      "password_credential '" + name + "' is not to be found here: $CREDENTIALS_DIRECTORY " +
      (given == nullptr ? "is not set" : "is " + std::string(given) + " and has no such file") +
      " (systemd sets it for a service with LoadCredential=" + name + ":FILE), and " + beside.string() +
      (error ? ": " + error.message() + "; run this command as root"
             : " does not exist; write the password into it (mode 600), or use password_file"));
}

}  // namespace

std::filesystem::path passwordFile(const CameraConfiguration& camera) {
  return camera.password_file.empty() ? credentialFile(camera) : camera.password_file;
}

std::string readPassword(const CameraConfiguration& camera) {
  if (camera.username.empty()) return {};
  return capture::readPasswordFile(passwordFile(camera));
}

}  // namespace cartvo::daemon
