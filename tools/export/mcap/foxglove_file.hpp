#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "tools/export/export_source.hpp"

namespace cartvo {

/// Writes an MCAP file with Foxglove's messages:
/// - /odometry (Odometry): valid pairs of a replay
/// - /pose (PoseInFrame) and /tf (FrameTransform): each pair; the cameras' frames for a replay only
/// - /left/video, /right/video (CompressedVideo): the pictures of a recording, as the cameras sent them
/// - /log (Log): each change between valid and invalid, with the reasons
///
/// The time of a message is when it could be received (receptionTime; the arrival of a picture), its
/// timestamp the exposure. `progress` gets the number of pictures written so far. The file appears when it is
/// complete. Throws std::runtime_error naming the file and the reason.
void writeFoxgloveFile(const std::filesystem::path& file, const ExportSource& source,
                       const std::function<void(std::size_t pictures)>& progress);

}  // namespace cartvo
