#pragma once

#include <filesystem>

namespace cartvo {

/// Writes the file's or folder's data to the disk, so that they survive a power cut. Throws
/// std::runtime_error naming the path and the reason.
void syncToDisk(const std::filesystem::path& path);

}  // namespace cartvo
