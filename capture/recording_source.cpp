#include "capture/recording_source.hpp"

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "capture/recording_clock.hpp"
#include "capture/video_decoder.hpp"

namespace cartvo {
namespace {

/// One sentence for health: the first place, and how much there is in all.
std::string summary(const RecordingDamage& damage, std::uint64_t replayed) {
  if (damage.places.empty()) return {};
  std::string text = damage.places.front();
  if (damage.places.size() > 1) text += " (and " + std::to_string(damage.places.size() - 1) + " more places)";
  return text + "; replayed the other " + std::to_string(replayed) + " pictures";
}

}  // namespace

struct RecordingSource::Implementation {
  Implementation(const std::filesystem::path& folder, CameraSide camera,
                 std::shared_ptr<RecordingClock> stamps)
      : side(camera), clock(std::move(stamps)), reader(folder, camera) {}

  bool advance();
  bool readUnit();

  CameraSide side;
  std::shared_ptr<RecordingClock> clock;  ///< null: the instants are those that were recorded

  RecordingReader reader;
  std::optional<VideoDecoder> decoder;
  std::optional<RecordedUnit> next;  ///< waits for the decoder of a new connection
  RecordedUnit current;
  std::uint64_t connection = 0;
  VideoCodec codec = VideoCodec::h264;
  std::uint64_t replayed = 0;
  bool at_end = false;
  std::atomic<bool> interrupted = false;

  mutable std::mutex mutex;  ///< guards health
  CameraHealth health;
};

RecordingSource::RecordingSource(const std::filesystem::path& folder, CameraSide side)
    : RecordingSource(folder, side, nullptr) {}

RecordingSource::RecordingSource(const std::filesystem::path& folder, CameraSide side,
                                 std::shared_ptr<RecordingClock> clock)
    : implementation_(std::make_unique<Implementation>(folder, side, std::move(clock))) {}

RecordingSource::~RecordingSource() = default;

/// The next picture, stamped anew if there is a clock to do so.
bool RecordingSource::Implementation::readUnit() {
  if (!reader.next(current)) return false;
  if (!clock) return true;
  EncodedUnit& unit = current.unit;
  const std::optional<StampedInstant> instant = clock->stamp(side, unit.order);
  if (!instant) return true;
  unit.exposure_ns = instant->exposure_ns;
  unit.exposure_deviation_ns = instant->deviation_ns;
  unit.undelayed_arrival_ns = instant->undelayed_arrival_ns;
  unit.instant_source = instant->source;
  return true;
}

/// Gives the decoder its next picture, and ends it before another connection's. False when there is no more.
bool RecordingSource::Implementation::advance() {
  if (next) {
    decoder.emplace(next->format, 1);
    connection = next->connection;
    codec = next->format.codec;
    decoder->send(std::exchange(next, std::nullopt)->unit);
    ++replayed;
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
  ++replayed;
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
    if (!self.advance()) break;
  }
  const std::lock_guard lock(self.mutex);
  self.health.state = CameraState::ended;
  self.health.last_error = summary(self.reader.damage(), self.replayed);
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

}  // namespace cartvo
