#pragma once

#include <filesystem>

namespace cartvo {

/// Writes the file's or folder's data to the disk, so that they survive a power cut. Throws
/// std::runtime_error naming the path and the reason.
void syncToDisk(const std::filesystem::path& path);

/// Throws std::runtime_error naming the path if it is a symbolic link. For files inside a folder that the
/// program fills by itself.
void refuseLink(const std::filesystem::path& path);

/// As refuseLink, for links of users other than the program's and root. For a folder that a person names, who
/// may have made the link.
void refuseLinkOfOthers(const std::filesystem::path& path);

}  // namespace cartvo
