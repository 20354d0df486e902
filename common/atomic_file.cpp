// Writing of files: atomic replacement of regular files, all else in place; files and folders that may stay
// unfinished.
#include "common/atomic_file.hpp"

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "common/files/temporary_file.hpp"

namespace cartvo {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

[[noreturn]] void failWith(const fs::path& file, const std::string& what, int error) {
  fail(file, what + ": " + std::generic_category().message(error));
}

/// A descriptor that is closed at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }

 private:
  int number_;
};

/// The file that a path names once its links are followed.
struct Target {
  fs::path path;
  int descriptor = -1;                ///< of this process, for paths such as /dev/stdout; -1: none
  std::optional<struct stat> status;  ///< empty: no such file yet
  bool in_process_folder = false;     ///< `path` is a link in /proc to another process's descriptor
};

/// The number N of a path in the process's folder of open descriptors; -1 otherwise.
int ownDescriptor(const fs::path& folder, const std::string& name) {
  if (folder != "/proc/" + std::to_string(::getpid()) + "/fd") return -1;
  int number = -1;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  return error == std::errc{} && end == name.data() + name.size() ? number : -1;
}

Target followLinks(const fs::path& file) {
  constexpr int kMaxLinks = 40;  // as in path_resolution(7)
  Target target{file, -1, {}, false};
  std::error_code error;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target.path, error)); ++links) {
    if (links == kMaxLinks) failWith(file, "cannot be written", ELOOP);
    const fs::path folder = fs::canonical(fs::absolute(target.path).parent_path(), error);
    target.descriptor = ownDescriptor(folder, target.path.filename());
    target.in_process_folder = target.descriptor < 0 && folder.string().starts_with("/proc/");
    if (target.descriptor >= 0 || target.in_process_folder) break;
    const fs::path next = fs::read_symlink(target.path, error);
    if (error) failWith(file, "cannot be written", error.value());
    target.path = next.is_absolute() ? next : target.path.parent_path() / next;
  }
  return target;
}

Target resolve(const fs::path& file) {
  if (file.filename().empty()) fail(file, "names no file");
  Target target = followLinks(file);
  struct stat status {};
  if (::stat(target.path.c_str(), &status) == 0) {
    target.status = status;
  } else if (errno != ENOENT) {
    failWith(file, "cannot be written", errno);
  }
  return target;
}

/// Whether a new file in the place of this one would lack something that the old one has.
bool losesByReplacement(const Target& target) {
  return target.in_process_folder || !S_ISREG(target.status->st_mode) || target.status->st_nlink > 1 ||
         ::listxattr(target.path.c_str(), nullptr, 0) > 0;
}

/// Throws if an existing target cannot be opened for writing, or must not be.
void checkExisting(const Target& target, const fs::path& file) {
  const mode_t mode = target.status->st_mode;
  if (S_ISDIR(mode)) fail(file, "is a folder; name a file");
  if (S_ISBLK(mode)) fail(file, "is a block device, whose contents are not overwritten; name a file");
  if (S_ISSOCK(mode)) fail(file, "is a socket; name a file");
  if (::access(target.path.c_str(), W_OK) != 0) failWith(file, "cannot be written", errno);
}

void writeInPlace(const Target& target, std::string_view contents, const fs::path& file) {
  const Descriptor descriptor(::open(target.path.c_str(), O_WRONLY | O_TRUNC | O_NOCTTY | O_CLOEXEC));
  if (descriptor.number() < 0) failWith(file, "cannot be written", errno);
  const int error = writeAll(descriptor.number(), contents);
  if (error != 0) failWith(file, "cannot be written", error);
}

/// A new file has the mode of the umask; one that replaces another is private until it has the other's mode.
mode_t modeFor(const Target& target) {
  constexpr mode_t kOfUmask = 0666, kPrivate = 0600;
  return target.status ? kPrivate : kOfUmask;
}

/// Replaces the target; returns false, with the target unchanged, if only writing in place is possible.
bool replace(const Target& target, std::string_view contents, const fs::path& file) {
  TemporaryFile temporary(target.path, modeFor(target));
  if (!temporary.isOpen()) {
    if (target.status) return false;
    failWith(file, "no file can be made in the folder " + folderOf(target.path).string(), errno);
  }
  if (target.status && !temporary.takeOwner(*target.status)) return false;
  int error = writeAll(temporary.descriptor(), contents);
  if (error != 0) failWith(file, "cannot be written", error);
  if (::fsync(temporary.descriptor()) != 0) failWith(file, "cannot be synced to the disk", errno);
  error = temporary.moveToTarget();
  if (error != 0 && !(error == EBUSY && target.status)) failWith(file, "cannot be renamed into place", error);
  return error == 0;
}

void write(const Target& target, std::string_view contents, const fs::path& file) {
  if (target.descriptor >= 0) {
    std::fflush(stdout);
    const int error = writeAll(target.descriptor, contents);
    if (error != 0) failWith(file, "cannot be written", error);
    return;
  }
  if (target.status) checkExisting(target, file);
  if (target.status && losesByReplacement(target)) return writeInPlace(target, contents, file);
  if (!replace(target, contents, file)) writeInPlace(target, contents, file);
}

fs::path targetOf(const fs::path& file) {
  checkFileCanBeWritten(file);
  std::error_code error;
  if (!fs::exists(file, error)) return file;
  fs::path target = fs::canonical(file);
  if (!fs::is_regular_file(target))
    throw std::runtime_error(file.string() + ": is not a regular file; name a new file");
  return target;
}

}  // namespace

void writeFileAtomically(const fs::path& file, std::string_view contents) {
  write(resolve(file), contents, file);
}

void writeResultFile(const fs::path& file, std::string_view contents) {
  const Target target = resolve(file);
  const bool is_new = target.descriptor < 0 && !target.status;
  if (is_new && target.path.has_parent_path()) createFolders(target.path.parent_path());
  write(target, contents, file);
}

void checkFileCanBeWritten(const fs::path& file) {
  const Target target = resolve(file);
  if (target.descriptor >= 0) {
    const int flags = ::fcntl(target.descriptor, F_GETFL);
    if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) failWith(file, "cannot be written", EBADF);
    return;
  }
  if (target.status) return checkExisting(target, file);
  std::vector<fs::path> created;
  if (target.path.has_parent_path()) created = createFolders(target.path.parent_path());
  const int error = TemporaryFile(target.path, modeFor(target)).isOpen() ? 0 : errno;
  std::error_code ignored;
  for (; !created.empty(); created.pop_back())
    fs::remove(created.back(), ignored);
  if (error != 0)
    failWith(file, "no file can be made in the folder " + folderOf(target.path).string(), error);
}

std::vector<fs::path> createFolders(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path path = fs::absolute(folder).lexically_normal(); !fs::exists(path, error) && !error;
       path = path.parent_path()) {
    if (!path.filename().empty()) missing.insert(missing.begin(), path);
  }
  fs::create_directories(folder, error);
  if (!error && !fs::is_directory(folder)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) failWith(folder, "the folder cannot be created", error.value());
  return missing;
}

AtomicFileWriter::AtomicFileWriter(fs::path file) : file_(std::move(file)), target_(targetOf(file_)) {
  constexpr mode_t kOfUmask = 0666;
  created_ = createFolders(folderOf(target_));
  contents_.emplace(target_, kOfUmask);
  if (!contents_->isOpen())
    failWith(file_, "no file can be made in the folder " + folderOf(target_).string(), errno);
}

AtomicFileWriter::~AtomicFileWriter() {
  contents_.reset();
  if (committed_) return;
  std::error_code not_empty;
  for (; !created_.empty(); created_.pop_back())
    fs::remove(created_.back(), not_empty);
}

void AtomicFileWriter::write(std::string_view contents) {
  if (const int error = writeAll(contents_->descriptor(), contents); error != 0)
    failWith(file_, "cannot be written", error);
}

void AtomicFileWriter::commit() {
  struct stat old {};
  if (::stat(target_.c_str(), &old) == 0 && !contents_->takeOwner(old))
    failWith(file_, "cannot be replaced by a file of the same owner and mode", errno);
  if (::fsync(contents_->descriptor()) != 0) failWith(file_, "cannot be synced to the disk", errno);
  if (const int error = contents_->moveToTarget(); error != 0)
    failWith(file_, "cannot be renamed into place", error);
  committed_ = true;
}

UnfinishedFolder::UnfinishedFolder(const fs::path& folder)
    : folder_(folder), created_(createFolders(folder)), was_empty_(fs::is_empty(folder)) {}

void UnfinishedFolder::remove() {
  if (!was_empty_) return;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder_, ignored), end; entry != end; entry.increment(ignored))
    fs::remove_all(entry->path(), ignored);
  for (; !created_.empty(); created_.pop_back())
    fs::remove(created_.back(), ignored);
}

}  // namespace cartvo
