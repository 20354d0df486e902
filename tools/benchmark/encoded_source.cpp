// A camera source that decodes an H.264 stream from memory.
#include "tools/benchmark/encoded_source.hpp"

#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "capture/codec/video_decoder.hpp"

namespace cartvo::benchmark {
namespace {

class EncodedStreamSource final : public CameraSource {
 public:
  /// `stream` must be part of the pair that `owner` keeps alive.
  EncodedStreamSource(std::shared_ptr<const simulate::EncodedPair> owner,
                      const simulate::EncodedStream& stream)
      : owner_(std::move(owner)), stream_(stream), decoder_(StreamFormat{}, 1) {}

  ReadOutcome read(Frame& frame, std::chrono::milliseconds /*timeout*/) override {
    while (!interrupted_) {
      if (std::optional<Frame> decoded = decoder_.receive()) {
        frame = *std::move(decoded);
        ++frames_;
        return ReadOutcome::frame;
      }
      if (is_finished_) break;
      if (next_ < stream_.units.size()) {
        decoder_.send(nextUnit());
      } else {
        decoder_.finish();
        is_finished_ = true;
      }
    }
    return ReadOutcome::ended;
  }

  CameraHealth health() const override {
    CameraHealth health;
    health.state = CameraState::streaming;
    health.frames = frames_;
    return health;
  }

  void interrupt() noexcept override { interrupted_ = true; }

 private:
  EncodedUnit nextUnit() {
    const simulate::AccessUnit& unit = stream_.units[next_];
    const auto data = stream_.data(unit);
    EncodedUnit sent;
    sent.data.assign(data.begin(), data.end());
    sent.pts = std::llround(static_cast<double>(unit.instant_ns) * 9e-5);  // 90 kHz
    sent.exposure_ns = unit.instant_ns;
    sent.arrival_ns = unit.instant_ns;
    sent.sequence = next_++;
    sent.instant_source = InstantSource::file;
    sent.key = unit.key_frame;
    return sent;
  }

  std::shared_ptr<const simulate::EncodedPair> owner_;
  const simulate::EncodedStream& stream_;
  VideoDecoder decoder_;
  std::size_t next_ = 0;
  bool is_finished_ = false;
  std::atomic<std::uint64_t> frames_ = 0;
  std::atomic<bool> interrupted_ = false;
};

}  // namespace

StereoSource openEncoded(const std::shared_ptr<const simulate::EncodedPair>& streams) {
  StereoSource source;
  source.kind = SourceKind::recording;
  source.left = std::make_unique<EncodedStreamSource>(streams, streams->left);
  source.right = std::make_unique<EncodedStreamSource>(streams, streams->right);
  source.period_ns = std::llround(1e9 / streams->left.frame_rate);
  source.pairs = std::min(streams->left.units.size(), streams->right.units.size());
  return source;
}

}  // namespace cartvo::benchmark
