#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "capture/camera_source.hpp"

namespace cartvo {

/// What recording.json says.
struct RecordingInfo {
  int format_version = 0;
  std::string software_version;
  std::string configuration;
  std::string rig;
};

/// Whether the folder holds a recording made by StreamRecorder.
bool isRecording(const std::filesystem::path& folder);

/// Throws std::runtime_error if recording.json is missing, damaged or of a later format.
RecordingInfo readRecordingInfo(const std::filesystem::path& folder);

/// Replays one camera of a recording through the decoder that live streams go through: the same frames with
/// the same instants, sequence numbers and status come out. Never waits. Where the file is cut short or
/// damaged the frames end, and `health().last_error` says so.
class RecordingSource : public CameraSource {
 public:
  /// `stream` is "left" or "right". Throws std::runtime_error if the stream or its index cannot be opened.
  RecordingSource(const std::filesystem::path& folder, const std::string& stream);
  ~RecordingSource() override;
  RecordingSource(const RecordingSource&) = delete;
  RecordingSource& operator=(const RecordingSource&) = delete;

  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
