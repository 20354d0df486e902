// A camera source that decodes an H.264 stream from memory.
#include "tools/benchmark/encoded_source.hpp"

#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "capture/codec/video_decoder.hpp"

namespace cartvo::benchmark {
namespace {

class EncodedStreamSource final : public capture::CameraSource {
 public:
  /// `stream` must be part of the pair that `owner` keeps alive.
  EncodedStreamSource(std::shared_ptr<const simulate::EncodedPair> owner,
                      const simulate::EncodedStream& stream)
      : owner_(std::move(owner)), stream_(stream), decoder_(capture::StreamFormat{}, 1) {}

  capture::ReadOutcome read(capture::Frame& frame, std::chrono::milliseconds /*timeout*/) override {
    while (!interrupted_) {
      if (std::optional<capture::Frame> decoded = decoder_.receive()) {
        frame = *std::move(decoded);
        ++frames_;
        return capture::ReadOutcome::frame;
      }
      if (is_finished_) break;
      if (next_ < stream_.units.size()) {
        decoder_.send(nextUnit());
      } else {
        decoder_.finish();
        is_finished_ = true;
      }
    }
    return capture::ReadOutcome::ended;
  }

  capture::CameraHealth health() const override {
    capture::CameraHealth health;
    health.state = capture::CameraState::streaming;
    health.frames = frames_;
    return health;
  }

  void interrupt() noexcept override { interrupted_ = true; }

 private:
  capture::EncodedUnit nextUnit() {
    const simulate::AccessUnit& unit = stream_.units[next_];
    const auto data = stream_.data(unit);
    capture::EncodedUnit sent;
    sent.data.assign(data.begin(), data.end());
    sent.pts = std::llround(static_cast<double>(unit.instant_ns) * 9e-5);  // 90 kHz
    sent.exposure_ns = unit.instant_ns;
    sent.arrival_ns = unit.instant_ns;
    sent.sequence = next_++;
    sent.instant_source = capture::InstantSource::file;
    sent.key = unit.key_frame;
    return sent;
  }

  std::shared_ptr<const simulate::EncodedPair> owner_;
  const simulate::EncodedStream& stream_;
  capture::VideoDecoder decoder_;
  std::size_t next_ = 0;
  bool is_finished_ = false;
  std::atomic<std::uint64_t> frames_ = 0;
  std::atomic<bool> interrupted_ = false;
};

}  // namespace

capture::StereoSource openEncoded(const std::shared_ptr<const simulate::EncodedPair>& streams) {
  capture::StereoSource source;
  source.kind = capture::SourceKind::recording;
  source.left = std::make_unique<EncodedStreamSource>(streams, streams->left);
  source.right = std::make_unique<EncodedStreamSource>(streams, streams->right);
  source.period_ns = std::llround(1e9 / streams->left.frame_rate);
  source.pairs = std::min(streams->left.units.size(), streams->right.units.size());
  return source;
}

}  // namespace cartvo::benchmark
