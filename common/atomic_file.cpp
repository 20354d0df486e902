// Atomic file writing: temporary file, fsync, rename.
#include "common/atomic_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace cartvo {
namespace {

/// An open temporary file. The destructor closes it, and removes it unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target)
      : target_(target), name_(target.string() + ".XXXXXX"), descriptor_(mkstemp(name_.data())) {
    if (descriptor_ < 0) fail("cannot create a temporary file beside it");
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!renamed_) unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::string_view contents) {
    while (!contents.empty()) {
      const ssize_t written = ::write(descriptor_, contents.data(), contents.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("cannot write");
      contents.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void moveToTarget() {
    constexpr mode_t kReadableByAll = 0644;
    if (fchmod(descriptor_, kReadableByAll) != 0) fail("cannot set its permissions");
    if (fsync(descriptor_) != 0) fail("cannot sync it to the disk");
    if (std::rename(name_.c_str(), target_.c_str()) != 0) fail("cannot rename it into place");
    renamed_ = true;
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    const int error = errno;
    throw std::runtime_error(target_.string() + ": " + what + ": " + std::generic_category().message(error));
  }

  std::filesystem::path target_;
  std::string name_;
  int descriptor_;
  bool renamed_ = false;
};

}  // namespace

void writeFileAtomically(const std::filesystem::path& file, std::string_view contents) {
  TemporaryFile temporary(file);
  temporary.write(contents);
  temporary.moveToTarget();
}

}  // namespace cartvo
