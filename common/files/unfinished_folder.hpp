#pragma once

#include <filesystem>
#include <vector>

namespace cartvo {

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
