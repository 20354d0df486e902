// Camera passwords: from files that only the daemon's user may read, never from the configuration itself.

#include "daemon/credentials.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <sys/stat.h>

namespace cartvo {
namespace {

constexpr off_t kLargestPassword = 1024;

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
  const std::filesystem::path file =
      camera.password_file.empty() ? credentialFile(camera.password_credential) : camera.password_file;

  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) {
    throw std::runtime_error(file.string() + ": cannot be read: " + std::strerror(errno) +
                             "; write the camera's password into it");
  }
  if ((status.st_mode & S_IRWXO) != 0) {
    throw std::runtime_error(file.string() +
                             ": other users have access to this password; run: chmod o= " + file.string());
  }
  if (!S_ISREG(status.st_mode) || status.st_size > kLargestPassword) {
    throw std::runtime_error(file.string() + ": expected a file of one line with the camera's password");
  }
  std::ifstream stream(file);
  std::string password;
  if (!stream || !std::getline(stream, password) || password.empty()) {
    throw std::runtime_error(file.string() + ": expected one line with the camera's password, found none");
  }
  if (password.back() == '\r') password.pop_back();
  return password;
}

}  // namespace cartvo
