#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <sys/stat.h>

namespace cartvo {

/// A new file in the folder of its target, which takes the target's name when it is complete. Before that it
/// has no name, so that nothing is left of it when the program ends early; only on file systems without
/// unnamed files (vfat, NFS) it has a temporary name, which stays if a signal ends the program.
class TemporaryFile {
 public:
  /// `mode`: permission bits, from which the umask is taken. On failure isOpen() is false and errno is set.
  TemporaryFile(std::filesystem::path target, mode_t mode);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  bool isOpen() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

  /// A path by which this process can open the file.
  std::filesystem::path openPath() const;

  /// Gives the file the owner and mode of `status`; returns false, with errno, if that is not possible.
  bool takeOwner(const struct stat& status) const;

  /// Gives the file the name of its target, whose file is replaced; returns 0 or the error number.
  int moveToTarget();

 private:
  int linkAs(const std::string& name) const;

  std::filesystem::path target_;
  std::string name_;  ///< beside the target; empty while the file has none
  int descriptor_ = -1;
};

/// Writes all to a descriptor; returns 0 or the error number.
int writeAll(int descriptor, std::string_view contents);

/// The folder of a file, "." for a name alone.
std::filesystem::path folderOf(const std::filesystem::path& file);

}  // namespace cartvo
