#pragma once

#include <filesystem>
#include <string>

namespace cartvo::capture {

/// Reads a camera's password: the only line of a file in UTF-8, or in UTF-16 with a byte order mark. A byte
/// order mark and the line's end (LF, CR LF) do not belong to it. Throws std::runtime_error, naming the file
/// but not its content, if it is missing, empty, larger than 1 KiB, accessible to other users, or not clearly
/// one password: with further lines, control characters, or a blank at the line's ends. The process then
/// writes no core dump any more, and only root can read its memory.
std::string readPasswordFile(const std::filesystem::path& file);

/// The same for another secret. `secret`: what errors call it, such as "the camera's password".
std::string readSecretFile(const std::filesystem::path& file, const std::string& secret);

}  // namespace cartvo::capture
