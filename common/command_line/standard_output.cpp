// Checks that standard output received everything; messages for errors of the file system.
#include "common/command_line/standard_output.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace cartvo {

void occupyStandardDescriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    // Takes the lowest free number, which is this one. Reading only: writing to it must stay an error.
    if (::open("/dev/null", O_RDONLY) != descriptor) return;
  }
}

std::string standardOutputError() {
  const bool failed_before = std::ferror(stdout) != 0;
  errno = 0;
  if (std::fflush(stdout) == 0 && !failed_before) return {};
  const std::string reason = errno == 0 ? "" : ": " + std::generic_category().message(errno);
  return "standard output cannot be written" + reason + "; the output is not complete";
}

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
