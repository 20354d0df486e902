#pragma once

#include <filesystem>
#include <string>

namespace cartvo::simulate {

/// The password in the file, if it is there and only its owner can read it; otherwise a new random one, which
/// is written there (mode 0600). Throws std::runtime_error naming the file if it cannot be written or is
/// empty.
std::string ensurePassword(const std::filesystem::path& file);

}  // namespace cartvo::simulate
