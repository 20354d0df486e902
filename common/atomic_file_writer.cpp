// Writes a large file piece by piece; it appears when it is complete.
#include "common/atomic_file_writer.hpp"

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/atomic_file.hpp"

namespace cartvo {
namespace fs = std::filesystem;
namespace {

constexpr mode_t kOfUmask = 0666;
constexpr mode_t kPermissionBits = 07777;

fs::path folderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

AtomicFileWriter::AtomicFileWriter(fs::path file) : file_(std::move(file)), target_(file_) {
  checkFileCanBeWritten(file_);
  std::error_code error;
  if (fs::exists(file_, error)) {
    target_ = fs::canonical(file_);
    if (!fs::is_regular_file(target_))
      throw std::runtime_error(file_.string() + ": is not a regular file; name a new file");
  }
  created_ = createFolders(folderOf(target_));
  descriptor_ = ::open(folderOf(target_).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, kOfUmask);
  if (descriptor_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == ENOENT)) {
    temporary_name_ = unusedName();
    descriptor_ =
        ::open(temporary_name_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kOfUmask);
  }
  if (descriptor_ < 0) fail("no file can be made in the folder " + folderOf(target_).string(), errno);
}

AtomicFileWriter::~AtomicFileWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (committed_) return;
  if (!temporary_name_.empty()) ::unlink(temporary_name_.c_str());
  std::error_code not_empty;
  for (; !created_.empty(); created_.pop_back())
    fs::remove(created_.back(), not_empty);
}

void AtomicFileWriter::fail(const std::string& what, int error) const {
  throw std::runtime_error(file_.string() + ": " + what + ": " + std::generic_category().message(error));
}

std::string AtomicFileWriter::unusedName() const {
  std::string name;
  struct stat status {};
  for (int count = 1; name.empty() || ::lstat(name.c_str(), &status) == 0; ++count)
    name = target_.string() + "." + std::to_string(::getpid()) + "-" + std::to_string(count);
  return name;
}

void AtomicFileWriter::write(std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t written = ::write(descriptor_, contents.data(), contents.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot be written", errno);
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
}

fs::path AtomicFileWriter::openPath() const {
  return "/proc/self/fd/" + std::to_string(descriptor_);
}

void AtomicFileWriter::keepOwner() const {
  struct stat old {
  }, own{};
  if (::stat(target_.c_str(), &old) != 0) return;
  if (::fstat(descriptor_, &own) != 0) fail("cannot be read", errno);
  const bool has_owner = own.st_uid == old.st_uid && own.st_gid == old.st_gid;
  if (!has_owner && ::fchown(descriptor_, old.st_uid, old.st_gid) != 0)
    fail("cannot be replaced by a file of the same owner", errno);
  if (::fchmod(descriptor_, old.st_mode & kPermissionBits) != 0)
    fail("cannot be replaced by a file of the same mode", errno);
}

void AtomicFileWriter::commit() {
  keepOwner();
  if (::fsync(descriptor_) != 0) fail("cannot be synced to the disk", errno);
  if (temporary_name_.empty()) {
    // An unnamed file cannot take the place of an existing one: it gets a name beside it first.
    const std::string name = unusedName();
    if (::linkat(AT_FDCWD, openPath().c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0)
      fail("cannot be given its name", errno);
    temporary_name_ = name;
  }
  if (std::rename(temporary_name_.c_str(), target_.c_str()) != 0) fail("cannot be renamed into place", errno);
  committed_ = true;
}

}  // namespace cartvo
