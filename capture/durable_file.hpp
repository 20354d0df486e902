#pragma once

#include <filesystem>

namespace cartvo {

/// What was written to the file or folder survives a power cut once this returns. Throws std::runtime_error
/// naming it and the reason.
void syncToDisk(const std::filesystem::path& path);

}  // namespace cartvo
