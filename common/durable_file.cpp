// Synchronisation of files and folders to the disk.

#include "common/durable_file.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
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

}  // namespace cartvo
