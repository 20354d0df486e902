#pragma once

#include <filesystem>
#include <memory>

#include "capture/camera_side.hpp"
#include "capture/camera_source.hpp"
#include "capture/recording_reader.hpp"

namespace cartvo {

class RecordingClock;

/// Replays one camera of a recording through the decoder that live streams go through: the same frames with
/// the same instants (or a RecordingClock's), sequence numbers and status come out, with a new decoder where
/// a new connection began. Never waits. Where files are cut short or damaged it goes on behind, and at the
/// end `health().last_error` says what was lost.
class RecordingSource : public CameraSource {
 public:
  /// Throws std::runtime_error if the recording holds no picture of that camera.
  RecordingSource(const std::filesystem::path& folder, CameraSide side);
  RecordingSource(const std::filesystem::path& folder, CameraSide side,
                  std::shared_ptr<RecordingClock> clock);
  ~RecordingSource() override;
  RecordingSource(const RecordingSource&) = delete;
  RecordingSource& operator=(const RecordingSource&) = delete;

  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

  /// Of what was read so far. Only from the thread that reads.
  const RecordingDamage& damage() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
