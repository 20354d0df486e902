#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/camera_side.hpp"

// Folder layout and description file (recording.json) of a recording.

namespace cartvo::capture {

/// Version of the recording format. A recording is a folder that contains recording.json and one folder per
/// segment of about one minute (000000, 000001, ...) with left.mkv and right.mkv, the streams as received,
/// and left.csv and right.csv, their indices. Format 1 (before any release) had no segments.
inline constexpr int kRecordingFormatVersion = 2;

/// Content of recording.json.
struct RecordingInfo {
  int format_version = kRecordingFormatVersion;
  std::string software_version;  ///< version of cartvo that made the recording
  std::int64_t started_ns = 0;   ///< start, ns since the Unix epoch, host's clock
  std::string configuration;     ///< configuration in effect, without credentials
  std::string rig;               ///< text of the rig file
};

/// Whether the folder contains a recording.json.
bool isRecording(const std::filesystem::path& folder);

/// Reads recording.json. Throws std::runtime_error if it is missing, damaged or of another format version.
RecordingInfo readRecordingInfo(const std::filesystem::path& folder);

/// As above, from its text; `file` is its name for error messages.
RecordingInfo parseRecordingInfo(const std::string& text, const std::filesystem::path& file);

/// Writes recording.json durably. Throws std::runtime_error naming the file and the reason.
void writeRecordingInfo(const std::filesystem::path& folder, const RecordingInfo& info);

/// Number, folder and files of one segment.
struct RecordingSegment {
  std::uint64_t number = 0;
  std::filesystem::path folder;

  std::filesystem::path video(CameraSide side) const {
    return folder / (sideName(side) + std::string(".mkv"));
  }
  std::filesystem::path index(CameraSide side) const {
    return folder / (sideName(side) + std::string(".csv"));
  }
};

/// The segment with that number; does not access the disk.
RecordingSegment recordingSegment(const std::filesystem::path& recording, std::uint64_t number);

/// Lists the segments, oldest first. The first ones may have been deleted by the quota. Throws
/// std::filesystem::filesystem_error if the folder cannot be read.
std::vector<RecordingSegment> recordingSegments(const std::filesystem::path& recording);

}  // namespace cartvo::capture
