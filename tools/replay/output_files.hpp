#pragma once

#include <filesystem>
#include <string>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// Makes the folder that results are written into. Throws std::runtime_error if the path is something else.
void prepareOutputFolder(const std::filesystem::path& folder);

/// `timing.csv`: a row per pair: `pair`, the milliseconds of each stage (`rectify_ms`, ...), `total_ms`.
/// Reading and decoding of images are not part of it.
std::string timingCsv(const Replay& replay);

}  // namespace cartvo
