// Detection of symbolic links before a file is written.
#include "common/planted_link.hpp"

#include <stdexcept>

#include <sys/stat.h>
#include <unistd.h>

namespace cartvo {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* whose) {
  throw std::runtime_error(
      path.string() + ": is " + whose +
      ", through which another file would be written; remove it, or choose another folder");
}

}  // namespace

void refuseLink(const std::filesystem::path& path) {
  if (std::filesystem::is_symlink(path)) fail(path, "a symbolic link");
}

void refuseLinkOfOthers(const std::filesystem::path& path) {
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0 || !S_ISLNK(status.st_mode)) return;
  if (status.st_uid != geteuid() && status.st_uid != 0) fail(path, "a symbolic link of another user");
}

}  // namespace cartvo
