// Checks that standard output received everything.
#include "common/standard_output.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace cartvo {

std::string standardOutputError() {
  const bool failed_before = std::ferror(stdout) != 0;
  errno = 0;
  if (std::fflush(stdout) == 0 && !failed_before) return {};
  const std::string reason = errno == 0 ? "" : ": " + std::generic_category().message(errno);
  return "standard output cannot be written" + reason + "; the output is not complete";
}

}  // namespace cartvo
