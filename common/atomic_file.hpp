#pragma once

#include <filesystem>
#include <string_view>

namespace cartvo {

/// Writes a file atomically: into a temporary file beside it, which is synced and then renamed. A reader, or
/// a system after a power cut, finds either all of the old contents or all of the new ones. Throws
/// std::runtime_error naming the file and the reason.
void writeFileAtomically(const std::filesystem::path& file, std::string_view contents);

}  // namespace cartvo
