#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "capture/encoded_unit.hpp"

namespace cartvo {

/// What is written beside the streams so that a replay can do what the pipeline did.
struct RecordingSettings {
  std::filesystem::path folder;  ///< created if it is not there; must not hold a recording yet
  std::string configuration;     ///< the configuration in effect, without credentials
  std::string rig;               ///< the rig file's text
};

struct RecorderHealth {
  std::uint64_t units = 0;  ///< pictures written, of both cameras
  std::uint64_t bytes = 0;
  std::string error;  ///< why recording stopped; empty while it goes on
};

/// Writes both cameras' streams as received, without re-encoding: left.mkv and right.mkv, which players open,
/// with left.csv and right.csv, the instants of each picture, and recording.json. What is older than a second
/// survives a crash. A full disk or a failing one stops the recording, never the capture.
///
/// Each side may be fed by a thread of its own; `health` may be called from any.
class StreamRecorder {
 public:
  /// Throws std::runtime_error if the folder cannot be written or holds a recording already.
  explicit StreamRecorder(const RecordingSettings& settings);
  ~StreamRecorder();
  StreamRecorder(const StreamRecorder&) = delete;
  StreamRecorder& operator=(const StreamRecorder&) = delete;

  StreamObserver& left();
  StreamObserver& right();
  RecorderHealth health() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
