#include "capture/video_decoder.hpp"

#include <chrono>
#include <stdexcept>

#include "capture/ffmpeg.hpp"
#include "capture/ffmpeg_log.hpp"
#include "capture/luma_plane.hpp"

namespace cartvo {
namespace {

/// Frames the decoder may hold back at most (H.264's largest decoded picture buffer); bounds what is pending.
constexpr std::size_t kMostPending = 64;

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::shared_ptr<AVFrame> makeFrame() {
  std::shared_ptr<AVFrame> frame(av_frame_alloc(), [](AVFrame* f) { av_frame_free(&f); });
  if (!frame) throw std::bad_alloc();
  return frame;
}

}  // namespace

/// What belongs to a unit and comes out with its picture.
struct VideoDecoder::Pending {
  std::int64_t exposure_ns = 0;
  std::int64_t exposure_deviation_ns = 0;
  std::int64_t undelayed_arrival_ns = 0;
  std::int64_t arrival_ns = 0;
  std::uint64_t sequence = 0;
  std::uint64_t order = 0;
  InstantSource instant_source = InstantSource::arrival;
  FrameStatus status = FrameStatus::good;
  bool key = false;
};

struct VideoDecoder::Implementation {
  ffmpeg::CodecContext context;
  ffmpeg::Packet packet = ffmpeg::makePacket();
  std::deque<Pending> pending;
  bool send_failed = false;  ///< a unit was rejected since the last frame
  bool damaged = false;      ///< the decoder met errors since the last key frame
};

VideoDecoder::VideoDecoder(const StreamFormat& format, int threads)
    : implementation_(std::make_unique<Implementation>()) {
  keepFfmpegQuiet();
  const AVCodec* codec = avcodec_find_decoder(ffmpeg::codecId(format.codec));
  if (codec == nullptr) {
    throw std::runtime_error("this FFmpeg has no decoder for " +
                             std::string(avcodec_get_name(ffmpeg::codecId(format.codec))));
  }
  ffmpeg::CodecContext context(avcodec_alloc_context3(codec));
  if (!context) throw std::bad_alloc();
  context->flags |= AV_CODEC_FLAG_LOW_DELAY | AV_CODEC_FLAG_OUTPUT_CORRUPT;
  context->thread_type = FF_THREAD_SLICE;
  context->thread_count = threads;
  if (!format.parameter_sets.empty()) {
    AVCodecParameters* parameters = avcodec_parameters_alloc();
    if (parameters == nullptr) throw std::bad_alloc();
    parameters->codec_type = AVMEDIA_TYPE_VIDEO;
    parameters->codec_id = codec->id;
    ffmpeg::setExtradata(*parameters, format.parameter_sets);
    avcodec_parameters_to_context(context.get(), parameters);
    avcodec_parameters_free(&parameters);
  }
  if (const int error = avcodec_open2(context.get(), codec, nullptr); error < 0) {
    throw std::runtime_error("cannot start the video decoder: " + ffmpeg::errorText(error));
  }
  implementation_->context = std::move(context);
}

VideoDecoder::~VideoDecoder() = default;

void VideoDecoder::send(const EncodedUnit& unit) {
  Implementation& self = *implementation_;
  self.pending.push_back({unit.exposure_ns, unit.exposure_deviation_ns, unit.undelayed_arrival_ns,
                          unit.arrival_ns, unit.sequence, unit.order, unit.instant_source, unit.status,
                          unit.key});
  if (self.pending.size() > kMostPending) self.pending.pop_front();

  // Not reference-counted, so FFmpeg copies it, with the padding it needs.
  self.packet->data = const_cast<std::uint8_t*>(unit.data.data());  // only read
  self.packet->size = static_cast<int>(unit.data.size());
  self.packet->pts = static_cast<std::int64_t>(unit.sequence);  // comes back with the frame
  self.packet->flags = unit.key ? AV_PKT_FLAG_KEY : 0;
  const int error = avcodec_send_packet(self.context.get(), self.packet.get());
  self.packet->data = nullptr;
  self.packet->size = 0;
  if (error < 0) {
    ++failures_;
    self.send_failed = true;
  }
}

std::optional<Frame> VideoDecoder::receive() {
  Implementation& self = *implementation_;
  for (;;) {
    const std::shared_ptr<AVFrame> picture = makeFrame();
    const int error = avcodec_receive_frame(self.context.get(), picture.get());
    if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return std::nullopt;
    if (error < 0) {
      ++failures_;
      self.send_failed = true;
      return std::nullopt;
    }
    const auto sequence = static_cast<std::uint64_t>(picture->pts);
    while (!self.pending.empty() && self.pending.front().sequence < sequence)
      self.pending.pop_front();
    const cv::Mat luma = lumaPlane(*picture);
    if (self.pending.empty() || self.pending.front().sequence != sequence || luma.empty()) continue;
    const Pending pending = self.pending.front();
    self.pending.pop_front();

    const bool failed = (picture->flags & AV_FRAME_FLAG_CORRUPT) != 0 || picture->decode_error_flags != 0;
    Frame frame;
    frame.image = luma;
    frame.exposure_ns = pending.exposure_ns;
    frame.exposure_deviation_ns = pending.exposure_deviation_ns;
    frame.undelayed_arrival_ns = pending.undelayed_arrival_ns;
    frame.arrival_ns = pending.arrival_ns;
    frame.decoded_ns = nowNs();
    frame.sequence = pending.sequence;
    frame.order = pending.order;
    frame.instant_source = pending.instant_source;
    frame.status = damagedSince(pending, failed) ? FrameStatus::damaged : FrameStatus::good;
    frame.storage = picture;
    return frame;
  }
}

void VideoDecoder::finish() {
  avcodec_send_packet(implementation_->context.get(), nullptr);
}

/// Errors stay until a key frame, which is predicted from no other, comes through without one.
bool VideoDecoder::damagedSince(const Pending& pending, bool decoder_failed) {
  Implementation& self = *implementation_;
  if (pending.key) self.damaged = false;
  if (decoder_failed || (self.send_failed && !pending.key)) self.damaged = true;
  self.send_failed = false;
  return self.damaged || pending.status == FrameStatus::damaged;
}

}  // namespace cartvo
