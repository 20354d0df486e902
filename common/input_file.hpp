#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

// Reading of files that others wrote. A file is a regular file: a pipe or a device is refused without waiting
// for it.

namespace cartvo {

/// Throws std::runtime_error "FILE: cannot be read: REASON" unless `file` is a regular file that may be read.
/// For libraries that open files by name.
void requireInputFile(const std::filesystem::path& file);

/// The bytes of a file of at most `max_bytes`. Throws std::runtime_error naming the file and the reason.
std::string readInputFile(const std::filesystem::path& file, std::uintmax_t max_bytes);

/// As readInputFile, as UTF-8 text without byte order mark. UTF-16 with a byte order mark, as Windows writes
/// it, is converted.
std::string readInputText(const std::filesystem::path& file, std::uintmax_t max_bytes);

/// Text as readInputText returns it, from the bytes of a file.
std::string withoutByteOrderMark(std::string bytes);

}  // namespace cartvo
