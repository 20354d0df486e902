// Removes a folder that was not filled to the end.
#include "common/files/unfinished_folder.hpp"

#include <system_error>

#include "common/atomic_file.hpp"

namespace cartvo {
namespace fs = std::filesystem;

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
