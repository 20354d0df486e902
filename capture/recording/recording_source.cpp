// Replay of one camera of a recording, and the stamping anew of its pictures.
#include "capture/recording/recording_source.hpp"

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "capture/codec/video_decoder.hpp"

namespace cartvo::capture {
namespace {

/// Time stamps that wait while the other camera sends nothing, several hours of them; the oldest are dropped.
constexpr std::size_t kMaxWaiting = 1U << 20;

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

RecordingTimestamper::RecordingTimestamper(const std::filesystem::path& recording, ClockChoice choice)
    : timestamper_(choice),
      sides_{Side(RecordingIndexReader(recording, CameraSide::left)),
             Side(RecordingIndexReader(recording, CameraSide::right))} {}

/// Timestamps the picture that arrived next, of either camera. False at the end of both.
bool RecordingTimestamper::stampNext() {
  const IndexRow* left = sides_[0].next;
  const IndexRow* right = sides_[1].next;
  if (left == nullptr && right == nullptr) return false;
  const bool is_left = right == nullptr || (left != nullptr && left->order < right->order);
  const CameraSide which = is_left ? CameraSide::left : CameraSide::right;
  Side& side = sides_[static_cast<std::size_t>(which)];
  const IndexRow& row = *side.next;
  if (row.connection != side.connection) timestamper_.connect(which);
  side.connection = row.connection;
  const ExposureTimestamp timestamp =
      timestamper_.stamp(which, {row.pts, row.reference_us, row.first_arrival_ns});
  side.waiting.push_back({row.order, timestamp});
  if (side.waiting.size() > kMaxWaiting) side.waiting.pop_front();
  side.next = side.rows.next();
  return true;
}

std::optional<ExposureTimestamp> RecordingTimestamper::stamp(CameraSide which, std::uint64_t order) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  for (;;) {
    while (!side.waiting.empty() && side.waiting.front().order < order)
      side.waiting.pop_front();
    if (!side.waiting.empty()) break;
    if (!stampNext()) return std::nullopt;
  }
  if (side.waiting.front().order != order) return std::nullopt;
  const ExposureTimestamp timestamp = side.waiting.front().timestamp;
  side.waiting.pop_front();
  return timestamp;
}

struct RecordingSource::Implementation {
  Implementation(const std::filesystem::path& folder, CameraSide camera,
                 std::shared_ptr<RecordingTimestamper> shared_timestamper)
      : side(camera), timestamper(std::move(shared_timestamper)), reader(folder, camera) {}

  /// Sends the next picture to the decoder, or drains it before the next connection. False at the end.
  bool decodeNext() {
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
  /// Reads the next picture, with new time stamps if there is a timestamper.
  bool readUnit() {
    if (!reader.next(current)) return false;
    if (!timestamper) return true;
    EncodedUnit& unit = current.unit;
    const std::optional<ExposureTimestamp> timestamp = timestamper->stamp(side, unit.order);
    if (timestamp) setTimestamp(unit, *timestamp);
    if (!timestamp) ++unstamped;
    return true;
  }

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
