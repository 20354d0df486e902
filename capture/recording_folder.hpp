#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/camera_side.hpp"

namespace cartvo {

/// A recording is a folder: recording.json, and a folder for each segment of about a minute, 000000, 000001,
/// ... with left.mkv and right.mkv, the streams as received, and left.csv and right.csv, their indices.
/// Format 2; format 1 (before any release) had no segments.
inline constexpr int kRecordingFormatVersion = 2;

/// What recording.json says.
struct RecordingInfo {
  int format_version = kRecordingFormatVersion;
  std::string software_version;  ///< cartvo's that recorded it
  std::int64_t started_ns = 0;   ///< ns since the Unix epoch, host's clock
  std::string configuration;     ///< in effect, without credentials
  std::string rig;               ///< the rig file's text
};

/// Whether the folder holds a recording made by StreamRecorder.
bool isRecording(const std::filesystem::path& folder);

/// Throws std::runtime_error if recording.json is missing, damaged or of another format.
RecordingInfo readRecordingInfo(const std::filesystem::path& folder);

/// The same of its text; `file` names it in errors.
RecordingInfo parseRecordingInfo(const std::string& text, const std::filesystem::path& file);

/// Writes recording.json durably. Throws std::runtime_error naming the file and the reason.
void writeRecordingInfo(const std::filesystem::path& folder, const RecordingInfo& info);

/// "left" or "right".
const char* sideName(CameraSide side);

/// One segment's folder and files.
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

RecordingSegment recordingSegment(const std::filesystem::path& recording, std::uint64_t number);

/// The segments that there are, oldest first. The first ones may have been deleted for want of room. Throws
/// std::filesystem::filesystem_error if the folder cannot be read.
std::vector<RecordingSegment> recordingSegments(const std::filesystem::path& recording);

}  // namespace cartvo
