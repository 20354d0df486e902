#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/files/temporary_file.hpp"

// Writing of files that the user or the configuration names.

namespace cartvo {

/// Writes a file. Symbolic links are followed.
///
/// A regular file, and one that does not exist, is written atomically: into a temporary file in its folder
/// (see TemporaryFile), which is synced before it takes the name. A reader, or a system after a power cut,
/// finds either all of the old contents or all of the new ones. An existing file keeps its mode and owner; a
/// new one has those of the umask.
///
/// All else is opened and written: character devices, FIFOs, open descriptors of this process (/dev/stdout,
/// /dev/fd/N; standard output is flushed first), and regular files that a replacement would cut off: those
/// with several names, with extended attributes (access control lists), of an owner that this process cannot
/// give, that are mount points, or in a folder that does not allow it.
///
/// Throws std::runtime_error naming the file and the reason, also for a folder, a socket, a block device and
/// a write-protected file.
void writeFileAtomically(const std::filesystem::path& file, std::string_view contents);

/// As `writeFileAtomically`, for a file that the user names: missing folders are made.
void writeResultFile(const std::filesystem::path& file, std::string_view contents);

/// Throws as `writeResultFile` would, for use before long work. Leaves everything as it was.
void checkFileCanBeWritten(const std::filesystem::path& file);

/// Creates a folder and those above it that are missing. Returns the created ones, outermost first. Throws
/// std::runtime_error naming the folder and the reason.
std::vector<std::filesystem::path> createFolders(const std::filesystem::path& folder);

/// A regular file that is written piece by piece and appears only when it is complete, for contents too large
/// for writeFileAtomically. Nothing is left of it when the program ends early, see TemporaryFile. All errors
/// are std::runtime_error naming the file and the reason.
class AtomicFileWriter {
 public:
  /// Creates missing folders. Symbolic links are followed. Throws also if `file` exists and is not a regular
  /// file.
  explicit AtomicFileWriter(std::filesystem::path file);
  /// Discards the contents unless they were committed, and removes the folders that were created.
  ~AtomicFileWriter();
  AtomicFileWriter(const AtomicFileWriter&) = delete;
  AtomicFileWriter& operator=(const AtomicFileWriter&) = delete;

  /// Appends to the file.
  void write(std::string_view contents);

  /// A path by which this process can open the unfinished file, for libraries that write to a path.
  std::filesystem::path openPath() const { return contents_->openPath(); }

  /// Syncs the contents to the disk and gives them their name. A file of that name is replaced; the new one
  /// has its mode and owner.
  void commit();

 private:
  std::filesystem::path file_;    ///< as given, for messages
  std::filesystem::path target_;  ///< behind symbolic links
  std::vector<std::filesystem::path> created_;
  std::optional<TemporaryFile> contents_;
  bool committed_ = false;
};

/// A folder that is being filled. Unless it was kept, the destructor removes what was written: the folders
/// that the constructor made, or the contents of a folder that was empty before. Other folders keep all.
class UnfinishedFolder {
 public:
  /// Makes the folder and those above it that are missing. Throws std::runtime_error naming the folder and
  /// the reason.
  explicit UnfinishedFolder(const std::filesystem::path& folder);
  ~UnfinishedFolder() {
    if (!is_kept_) remove();
  }
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

  /// Keeps the content of the folder. Called at the end, also after the folder was renamed.
  void keep() { is_kept_ = true; }
  /// Removes what the destructor would remove.
  void remove();

  const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> created_;  ///< outermost first
  bool was_empty_ = false, is_kept_ = false;
};

}  // namespace cartvo
