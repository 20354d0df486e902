// Replay of one camera of a recording.

#include "capture/recording/recording_source.hpp"

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "capture/codec/video_decoder.hpp"
#include "capture/recording/recording_timestamper.hpp"

namespace cartvo::capture {
namespace {

/// One sentence for the health report: the first damage and the number of further ones; else the number of
/// pictures that were not stamped anew.
std::string damageText(const RecordingDamage& damage, std::uint64_t frames, std::uint64_t damaged,
                       std::uint64_t unstamped) {
  if (damage.places.empty()) {
    return unstamped == 0 ? ""
                          : std::to_string(unstamped) +
                                " pictures keep their recorded instants: the clock model has none for them";
  }
  std::string text = damage.places.front();
  if (damage.places.size() > 1) text += " (and " + std::to_string(damage.places.size() - 1) + " more places)";
  text += "; " + std::to_string(frames - damaged) + " of the " + std::to_string(frames + damage.lost) +
          " pictures are whole and were replayed";
  return text;
}

}  // namespace

struct RecordingSource::Implementation {
  Implementation(const std::filesystem::path& folder, CameraSide camera,
                 std::shared_ptr<RecordingTimestamper> shared_timestamper)
      : side(camera), timestamper(std::move(shared_timestamper)), reader(folder, camera) {}

  bool decodeNext();
  bool readUnit();

  CameraSide side;
  std::shared_ptr<RecordingTimestamper> timestamper;  ///< null: the recorded instants are used

  RecordingReader reader;
  std::optional<VideoDecoder> decoder;
  std::optional<RecordedUnit> next;  ///< first unit of the next connection, until its decoder is open
  RecordedUnit current;
  std::uint64_t connection = 0;
  VideoCodec codec = VideoCodec::h264;
  bool at_end = false;
  std::uint64_t unstamped = 0;  ///< pictures for which the timestamper has no instant
  std::atomic<bool> interrupted = false;

  mutable std::mutex mutex;  ///< guards health
  CameraHealth health;
};

RecordingSource::RecordingSource(const std::filesystem::path& folder, CameraSide side)
    : RecordingSource(folder, side, nullptr) {}

RecordingSource::RecordingSource(const std::filesystem::path& folder, CameraSide side,
                                 std::shared_ptr<RecordingTimestamper> timestamper)
    : implementation_(std::make_unique<Implementation>(folder, side, std::move(timestamper))) {}

RecordingSource::~RecordingSource() = default;

/// Reads the next picture, with new time stamps if there is a timestamper.
bool RecordingSource::Implementation::readUnit() {
  if (!reader.next(current)) return false;
  if (!timestamper) return true;
  EncodedUnit& unit = current.unit;
  const std::optional<ExposureTimestamp> timestamp = timestamper->stamp(side, unit.order);
  if (timestamp) setTimestamp(unit, *timestamp);
  if (!timestamp) ++unstamped;
  return true;
}

/// Sends the next picture to the decoder, or drains it before the next connection. False at the end.
bool RecordingSource::Implementation::decodeNext() {
  if (next) {
    decoder.emplace(next->format, 1);
    connection = next->connection;
    codec = next->format.codec;
    decoder->send(std::exchange(next, std::nullopt)->unit);
    return true;
  }
  if (at_end) return false;
  if (!readUnit()) {
    at_end = true;
    if (decoder) decoder->finish();
    return decoder.has_value();
  }
  if (!decoder || current.connection != connection || current.format.codec != codec) {
    if (decoder) decoder->finish();
    next = std::move(current);
    return true;
  }
  decoder->send(current.unit);
  return true;
}

ReadOutcome RecordingSource::read(Frame& frame, std::chrono::milliseconds /*timeout*/) {
  Implementation& self = *implementation_;
  while (!self.interrupted) {
    if (std::optional<Frame> decoded = self.decoder ? self.decoder->receive() : std::nullopt) {
      frame = std::move(*decoded);
      const std::lock_guard lock(self.mutex);
      self.health.state = CameraState::streaming;
      self.health.instant_source = frame.instant_source;
      ++self.health.frames;
      if (frame.status == FrameStatus::damaged) ++self.health.damaged;
      return ReadOutcome::frame;
    }
    if (!self.decodeNext()) break;
  }
  const std::lock_guard lock(self.mutex);
  self.health.state = CameraState::ended;
  self.health.last_error =
      damageText(self.reader.damage(), self.health.frames, self.health.damaged, self.unstamped);
  return ReadOutcome::ended;
}

CameraHealth RecordingSource::health() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->health;
}

const RecordingDamage& RecordingSource::damage() const {
  return implementation_->reader.damage();
}

void RecordingSource::interrupt() noexcept {
  implementation_->interrupted = true;
}

}  // namespace cartvo::capture
