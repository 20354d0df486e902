#pragma once

#include <filesystem>
#include <optional>

#include "tools/replay/replay.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// The exported data: the results of a replay, or poses alone.
struct ExportSource {
  std::filesystem::path path;
  std::optional<Replay> replay;  ///< empty if the source is a trajectory file
  bool has_video = false;        ///< `path` is a recording, with its encoded pictures
  Trajectory poses;              ///< of `frame`; of the body if there is a replay
  TrajectoryFrame frame = TrajectoryFrame::unknown;
};

/// Replays a recording or an image folder, or reads a trajectory file (TUM or EuRoC; a folder of
/// `cartvo replay --output-dir` stands for its trajectory.tum). `rig`: as ReplaySettings::rig. Throws
/// std::runtime_error naming the file and what was expected.
ExportSource readExportSource(const std::filesystem::path& path, const std::filesystem::path& rig,
                              const ReplayObserver& observer);

/// Instant at which a controller could have had the message of a pair, ns: the arrival of the pair, and the
/// exposure in an image folder, which has no arrivals.
std::int64_t receptionTime(const ReplayedPair& pair);

}  // namespace cartvo
