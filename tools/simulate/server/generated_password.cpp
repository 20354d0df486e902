// Generates the simulated cameras' password: neither on a command line nor in a file that others can read.
#include "tools/simulate/server/generated_password.hpp"

#include <cerrno>
#include <random>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "capture/rtsp/password_file.hpp"

namespace cartvo::simulate {
namespace {

std::string randomPassword() {
  constexpr std::string_view kLetters = "abcdefghijkmnpqrstuvwxyzABCDEFGHJKLMNPQRSTUVWXYZ23456789";
  constexpr int kLength = 20;
  std::random_device device;
  std::uniform_int_distribution<std::size_t> letter(0, kLetters.size() - 1);
  std::string password;
  for (int index = 0; index < kLength; ++index)
    password += kLetters[letter(device)];
  return password;
}

bool isPrivate(const std::filesystem::path& file) {
  struct stat status {};
  return stat(file.c_str(), &status) == 0 && (status.st_mode & 077U) == 0;
}

}  // namespace

std::string ensurePassword(const std::filesystem::path& file) {
  if (isPrivate(file)) return capture::readPasswordFile(file);
  std::string password = randomPassword();
  std::filesystem::remove(file);
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const std::string line = password + "\n";
  const bool written =
      descriptor >= 0 && ::write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (!written) {
    throw std::runtime_error(file.string() +
                             ": the password cannot be written: " + std::generic_category().message(error));
  }
  return password;
}

}  // namespace cartvo::simulate
