#pragma once

#include <filesystem>
#include <string>

namespace cartvo {

/// A camera's password: the first line of a file, without the line's end. Throws std::runtime_error naming
/// the file, never what is in it, if it is missing, empty, larger than 1 KiB, or if other users may read it.
std::string readPasswordFile(const std::filesystem::path& file);

}  // namespace cartvo
