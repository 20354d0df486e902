#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "tools/simulate/content.hpp"
#include "tools/simulate/stream/encode_content.hpp"
#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::simulate {

/// Writes the description of a drive, each file atomically: rig.yaml, poses.txt (KITTI: left camera
/// relative to the first pose; only if the truth is known), times_0.txt and times_1.txt (s since the
/// content's start, nine decimals). Creates the folder.
void writeDescription(const std::filesystem::path& folder, const ContentDescription& drive);

/// Writes truth.tum: T_world_body at the instants of ContentDescription::denseTruth() plus `epoch_ns`. No
/// file if the truth is unknown.
void writeTruth(const std::filesystem::path& folder, const ContentDescription& drive, std::int64_t epoch_ns);

/// Renames the truth.tum of an earlier run to truth-SECOND.tum, the Unix time of its first pose, which the
/// recordings of that run need. Returns the new file; nothing if there is none. Throws std::runtime_error,
/// and renames nothing, if the file is no such trajectory or the name is taken.
std::optional<std::filesystem::path> keepEarlierTruth(const std::filesystem::path& folder);

/// Writes an image folder in the KITTI layout: image_0 and image_1 (PNG), the description, truth.tum, and
/// calib.txt if the rig is rectified. The folder is complete or absent. Throws std::runtime_error if it
/// exists and is not empty.
void renderFolder(const std::filesystem::path& folder, const Content& content, const Progress& progress);

/// Writes a recording in the format of cartvod (docs/recordings.md) with the description and truth.tum. The
/// content starts at kRecordedEpoch_ns; a picture arrives when it is exposed. The same streams give the same
/// bytes. The folder is complete or absent. Throws std::runtime_error if it exists and is not empty.
void recordFolder(const std::filesystem::path& folder, const Content& content, const EncodedPair& streams);

/// Start of recorded contents: 2026-01-01 00:00 UTC, ns since the Unix epoch.
inline constexpr std::int64_t kRecordedEpoch_ns = 1'767'225'600'000'000'000;

}  // namespace cartvo::simulate
