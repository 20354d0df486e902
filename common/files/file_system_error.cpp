// Messages for errors of the file system that have none of their own.
#include "common/files/file_system_error.hpp"

#include <system_error>

namespace cartvo {

std::string textOf(const std::filesystem::filesystem_error& error) {
  const std::filesystem::path& path = error.path1();
  std::string text = path.string() + ": cannot be accessed: " + error.code().message();
  std::error_code no_current_folder;
  const std::filesystem::path current = std::filesystem::current_path(no_current_folder);
  if (current.empty() && path.is_relative())
    text += "; the current folder was removed: change to one that exists, or give whole paths";
  return text;
}

}  // namespace cartvo
