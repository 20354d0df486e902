#pragma once

#include <filesystem>
#include <string>

namespace cartvo::capture {

/// Why a file cannot be read as a video, for FFmpeg's "Invalid data": an MP4 without its index, an empty
/// file, or no known format. One sentence, with what to do.
std::string videoFileProblem(const std::filesystem::path& file);

/// Whether a file is an MP4 whose index (moov) is missing or truncated.
bool isUnfinishedMp4(const std::filesystem::path& file);

}  // namespace cartvo::capture
