#pragma once

#include <filesystem>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// Writes the odometry of a replay as an event log of LCM, which lcm-logplayer plays: an event of the channel
/// CARTVO_ODOMETRY for each pair, with the message as cartvod sends it. An event's time is receptionTime,
/// and so is publication_utime: the processing took no time. The file appears when it is complete. Throws
/// std::runtime_error naming the file and the reason.
void writeLcmLog(const std::filesystem::path& file, const Replay& replay);

}  // namespace cartvo
