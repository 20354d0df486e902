#pragma once

#include <span>
#include <string_view>

namespace cartvo::daemon {

/// A file of daemon/page/web/, compiled into the program.
struct PageFile {
  const char* path;  ///< on the server, such as "/page.js"
  const char* type;  ///< Content-Type
  std::string_view content;
};

std::span<const PageFile> pageFiles();

}  // namespace cartvo::daemon
