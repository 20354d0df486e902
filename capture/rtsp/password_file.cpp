// Reading of password files. Passwords are never part of a configuration or a command line.

#include "capture/rtsp/password_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>

namespace cartvo::capture {
namespace {

/// From now on this process writes no core dump, and only root can read its memory, also by a debugger.
void disableCoreDumps() {
  // The resource limit alone does not stop dumps into a pipe (core(5)). Neither call fails for these values.
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  prctl(PR_SET_DUMPABLE, 0L, 0L, 0L, 0L);
}

constexpr off_t kMaxFileSize = 1024;  // bytes

}  // namespace

std::string readPasswordFile(const std::filesystem::path& file) {
  return readSecretFile(file, "the camera's password");
}

std::string readSecretFile(const std::filesystem::path& file, const std::string& secret) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) {
    throw std::runtime_error(file.string() + ": cannot be read: " + std::strerror(errno) + "; write " +
                             secret + " into it");
  }
  if (!S_ISREG(status.st_mode) || status.st_size > kMaxFileSize) {
    throw std::runtime_error(file.string() + ": expected a file of one line with " + secret);
  }
  if ((status.st_mode & S_IRWXO) != 0) {
    throw std::runtime_error(file.string() +
                             ": other users have access to this password; run: chmod o= " + file.string());
  }
  disableCoreDumps();
  std::ifstream stream(file);
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be read: " + std::strerror(errno) +
                             "; give it to the user that runs this program");
  }
  std::string password;
  std::getline(stream, password);
  if (!password.empty() && password.back() == '\r') password.pop_back();
  if (password.empty()) {
    throw std::runtime_error(file.string() + ": expected one line with " + secret + ", found none");
  }
  return password;
}

}  // namespace cartvo::capture
