#pragma once

#include <filesystem>
#include <string>

namespace cartvo::capture {

/// Reads a camera's password: the first line of a file. Throws std::runtime_error, naming the file but not
/// its content, if it is missing, empty, larger than 1 KiB, or accessible to other users. The process then
/// writes no core dump any more, and only root can read its memory.
std::string readPasswordFile(const std::filesystem::path& file);

/// The same for another secret. `secret`: what errors call it, such as "the camera's password".
std::string readSecretFile(const std::filesystem::path& file, const std::string& secret);

}  // namespace cartvo::capture
