#pragma once

#include <filesystem>
#include <string>

// Files of other systems that cartvo does not read.

namespace cartvo {

/// Name of a file's format and how to convert it, such as "is a ROS 1 bag: ..."; empty for files of other
/// formats, and for what is no readable regular file. Reads the first bytes only.
std::string foreignFormat(const std::filesystem::path& file);

/// Whether a file begins with text, such as a rig, instants or a trajectory; not a playlist, which FFmpeg
/// plays.
bool isTextFile(const std::filesystem::path& file);

/// "contains NAME, which " and the foreignFormat of the first such file of a folder; empty if there is none.
std::string foreignContents(const std::filesystem::path& folder);

}  // namespace cartvo
