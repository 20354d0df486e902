#pragma once

#include <filesystem>
#include <memory>

#include "capture/camera_side.hpp"
#include "capture/camera_source.hpp"
#include "capture/recording/recording_reader.hpp"

namespace cartvo::capture {

class RecordingTimestamper;

/// Replays one camera of a recording through the decoder of live streams. Delivers the same frames with the
/// same instants (or those of a RecordingTimestamper), sequence numbers and status. Each connection gets a
/// new decoder. Never waits. Continues after truncated or damaged files; at the end `health().last_error`
/// describes the loss.
class RecordingSource : public CameraSource {
 public:
  /// Throws std::runtime_error if the recording contains no picture of that camera.
  RecordingSource(const std::filesystem::path& folder, CameraSide side);
  RecordingSource(const std::filesystem::path& folder, CameraSide side,
                  std::shared_ptr<RecordingTimestamper> timestamper);
  ~RecordingSource() override;
  RecordingSource(const RecordingSource&) = delete;
  RecordingSource& operator=(const RecordingSource&) = delete;

  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

  /// Damage found so far. Call only from the thread that reads.
  const RecordingDamage& damage() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::capture
