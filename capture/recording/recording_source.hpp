#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>

#include "capture/camera_side.hpp"
#include "capture/camera_source.hpp"
#include "capture/clock/stereo_timestamper.hpp"
#include "capture/recording/recording_index.hpp"
#include "capture/recording/recording_reader.hpp"

namespace cartvo::capture {

/// Recomputes the time stamps of a recording's pictures by the same clock model as live: from the RTP times,
/// sender reports and arrivals in the indices, of both cameras in the order of their arrival, whether or not
/// the videos can be read. Not thread-safe.
class RecordingTimestamper {
 public:
  RecordingTimestamper(const std::filesystem::path& recording, ClockChoice choice);

  /// Time stamp of the picture with that `order`; nothing if the index does not contain it. The pictures of
  /// one camera must be requested in increasing order.
  std::optional<ExposureTimestamp> stamp(CameraSide side, std::uint64_t order);

  /// As StereoTimestamper's.
  void setVisual(const std::optional<OffsetEstimate>& offset) { timestamper_.setVisual(offset); }
  ClockStatus status() const { return timestamper_.status(); }

 private:
  struct Stamped {
    std::uint64_t order = 0;
    ExposureTimestamp timestamp;
  };
  struct Side {
    explicit Side(RecordingIndexReader reader) : rows(std::move(reader)), next(rows.next()) {}

    RecordingIndexReader rows;
    const IndexRow* next;
    std::uint64_t connection = 0;
    std::deque<Stamped> waiting;  ///< timestamped, and not requested yet
  };

  bool stampNext();

  StereoTimestamper timestamper_;
  std::array<Side, 2> sides_;
};

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
