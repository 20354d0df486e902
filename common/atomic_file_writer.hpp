#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/files/temporary_file.hpp"

namespace cartvo {

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
  [[noreturn]] void fail(const std::string& what, int error) const;

  std::filesystem::path file_;    ///< as given, for messages
  std::filesystem::path target_;  ///< behind symbolic links
  std::vector<std::filesystem::path> created_;
  std::optional<TemporaryFile> contents_;
  bool committed_ = false;
};

}  // namespace cartvo
