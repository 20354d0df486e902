#pragma once

#include <filesystem>
#include <string_view>

namespace cartvo {

/// Writes a file so that a reader, or a power cut, meets the old contents or the new ones, whole: into a
/// temporary file beside it, synced, then renamed. Throws std::runtime_error naming the file and the reason.
void writeFileAtomically(const std::filesystem::path& file, std::string_view contents);

}  // namespace cartvo
