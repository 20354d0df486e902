// Synchronisation of files and folders to the disk, and links planted where files are to be written.

#include "common/durable_file.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace cartvo {

void syncToDisk(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && ::fdatasync(descriptor) == 0;
  // Devices and pipes, which tests write to, cannot be synced.
  const bool failed = !synced && errno != EINVAL && errno != EROFS;
  const int reason = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (failed) throw std::runtime_error("cannot write " + path.string() + ": " + std::strerror(reason));
}

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* whose) {
  throw std::runtime_error(
      path.string() + ": is " + whose +
      ", through which another file would be written; remove it, or choose another folder");
}

}  // namespace

void refuseLink(const std::filesystem::path& path) {
  if (std::filesystem::is_symlink(path)) fail(path, "a symbolic link");
}

void refuseLinkOfOthers(const std::filesystem::path& path) {
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0 || !S_ISLNK(status.st_mode)) return;
  if (status.st_uid != geteuid() && status.st_uid != 0) fail(path, "a symbolic link of another user");
}

}  // namespace cartvo
