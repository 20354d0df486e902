#pragma once

#include <filesystem>
#include <string>

namespace cartvo::simulate {

/// Returns the password in `file` if the file exists and only its owner can read it. Otherwise writes a new
/// random password to it (mode 0600). Throws std::runtime_error that names the file if it cannot be written
/// or is empty.
std::string ensurePassword(const std::filesystem::path& file);

}  // namespace cartvo::simulate
