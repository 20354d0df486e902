// Reads a camera's password, and the status page's token, from the configured file or credential.

#include "daemon/service/camera_password.hpp"

#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include "capture/rtsp/password_file.hpp"

namespace cartvo::daemon {
namespace {

/// The file of the credential `name`: in $CREDENTIALS_DIRECTORY, which systemd sets for the service, else in
/// the folder beside the configuration. `key`: of the configuration. Throws std::runtime_error that names
/// both.
std::filesystem::path credentialFile(const std::string& key, const std::string& name,
                                     const std::filesystem::path& credentials) {
  const char* given = std::getenv("CREDENTIALS_DIRECTORY");
  std::filesystem::path beside = credentials / name;
  std::error_code error;
  if (given != nullptr && std::filesystem::exists(std::filesystem::path(given) / name, error))
    return std::filesystem::path(given) / name;
  if (std::filesystem::exists(beside, error)) return beside;
  throw std::runtime_error(
      key + "_credential '" + name + "' is not to be found here: $CREDENTIALS_DIRECTORY " +
      (given == nullptr ? "is not set" : "is " + std::string(given) + " and has no such file") +
      " (systemd sets it for a service with LoadCredential=" + name + ":FILE), and " + beside.string() +
      (error ? ": " + error.message() + "; run this command as root"
             : " does not exist; write the " + key + " into it (mode 600), or use " + key + "_file"));
}

}  // namespace

std::filesystem::path passwordFile(const CameraConfiguration& camera) {
  if (!camera.password_file.empty()) return camera.password_file;
  return credentialFile("password", camera.password_credential, camera.credentials);
}

std::string readPassword(const CameraConfiguration& camera) {
  if (camera.username.empty()) return {};
  return capture::readPasswordFile(passwordFile(camera));
}

std::string readPageToken(const PageConfiguration& page) {
  if (page.token_file.empty() && page.token_credential.empty()) return {};
  const std::filesystem::path file = page.token_file.empty()
                                         ? credentialFile("token", page.token_credential, page.credentials)
                                         : page.token_file;
  return capture::readSecretFile(file, "the status page's token");
}

}  // namespace cartvo::daemon
