#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace cartvo::capture {

/// Reads a file of KITTI's raw recordings, timestamps.txt, with a date and a time (UTC) in each line, such as
/// 2011-09-26 13:02:25.594360375, as ns since the Unix epoch. Throws std::runtime_error naming file and line
/// if one is not of this form, the instants do not increase, or their intervals are not those of a camera.
std::vector<std::int64_t> readDatesAndTimes(const std::filesystem::path& file);

}  // namespace cartvo::capture
