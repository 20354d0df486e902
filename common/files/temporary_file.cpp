// A new file that takes its name when it is complete.
#include "common/files/temporary_file.hpp"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace cartvo {
namespace fs = std::filesystem;
namespace {

/// Opens a file without a name; -1 with errno 0 if there can be none here.
int openUnnamed(const fs::path& folder, mode_t mode) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
  if (descriptor < 0) {
    if (errno == EOPNOTSUPP || errno == EISDIR || errno == ENOENT) errno = 0;
    return -1;
  }
  // Its name is given through /proc, which a chroot may lack.
  if (::access("/proc/self/fd", X_OK) == 0) return descriptor;
  ::close(descriptor);
  errno = 0;
  return -1;
}

std::string unusedName(const fs::path& target) {
  static std::atomic<unsigned> count = 0;
  std::string name;
  struct stat status {};
  do {
    name = target.string() + "." + std::to_string(::getpid()) + "-" + std::to_string(++count);
  } while (::lstat(name.c_str(), &status) == 0);
  return name;
}

}  // namespace

TemporaryFile::TemporaryFile(fs::path target, mode_t mode)
    : target_(std::move(target)), descriptor_(openUnnamed(folderOf(target_), mode)) {
  if (isOpen() || errno != 0) return;
  const std::string name = unusedName(target_);
  descriptor_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
  if (isOpen()) name_ = name;
}

TemporaryFile::~TemporaryFile() {
  if (isOpen()) ::close(descriptor_);
  if (!name_.empty()) ::unlink(name_.c_str());
}

fs::path TemporaryFile::openPath() const {
  return "/proc/self/fd/" + std::to_string(descriptor_);
}

bool TemporaryFile::takeOwner(const struct stat& status) const {
  constexpr mode_t kPermissionBits = 07777;
  struct stat own {};
  if (::fstat(descriptor_, &own) != 0) return false;
  // The sandbox of the service has no fchown, which it does not need for its own files.
  const bool has_owner = own.st_uid == status.st_uid && own.st_gid == status.st_gid;
  return (has_owner || ::fchown(descriptor_, status.st_uid, status.st_gid) == 0) &&
         ::fchmod(descriptor_, status.st_mode & kPermissionBits) == 0;
}

int TemporaryFile::linkAs(const std::string& name) const {
  const bool is_linked =
      ::linkat(AT_FDCWD, openPath().c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  return is_linked ? 0 : errno;
}

int TemporaryFile::moveToTarget() {
  if (name_.empty()) {
    if (const int error = linkAs(target_.string()); error != EEXIST) return error;
    // A link cannot replace a file: the new one gets a name beside it first.
    std::string name = unusedName(target_);
    if (const int error = linkAs(name); error != 0) return error;
    name_ = std::move(name);
  }
  if (std::rename(name_.c_str(), target_.c_str()) != 0) return errno;
  name_.clear();
  return 0;
}

int writeAll(int descriptor, std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t written = ::write(descriptor, contents.data(), contents.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

fs::path folderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace cartvo
