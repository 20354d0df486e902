#pragma once

#include <filesystem>
#include <string>

namespace cartvo {

/// "PATH: cannot be accessed: REASON", with advice if the current folder does not exist any more.
std::string textOf(const std::filesystem::filesystem_error& error);

}  // namespace cartvo
