#pragma once

#include <filesystem>
#include <string>

namespace cartvo::capture {

/// Reads a camera's password: the first line of a file. Throws std::runtime_error, naming the file but not
/// its content, if it is missing, empty, larger than 1 KiB, or accessible to other users. The process then
/// writes no core dump any more, and only root can read its memory.
std::string readPasswordFile(const std::filesystem::path& file);

}  // namespace cartvo::capture
