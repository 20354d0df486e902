// H.264 and H.265 decoding through FFmpeg.

#include "capture/codec/video_decoder.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>
#include <vector>

#include "capture/codec/ffmpeg.hpp"
#include "capture/codec/ffmpeg_log.hpp"
#include "capture/codec/luma_plane.hpp"
#include "capture/codec/nal_units.hpp"
#include "common/host_clock.hpp"

namespace cartvo::capture {
namespace {

/// Maximum number of frames in the decoder (H.264's largest decoded picture buffer).
constexpr std::size_t kMaxPending = 64;

std::shared_ptr<AVFrame> makeFrame() {
  std::shared_ptr<AVFrame> frame(av_frame_alloc(), [](AVFrame* f) { av_frame_free(&f); });
  if (!frame) throw std::bad_alloc();
  return frame;
}

}  // namespace

/// Attributes of a unit in the decoder, for its frame.
struct VideoDecoder::Pending {
  std::int64_t exposure_ns = 0;
  std::int64_t exposure_stddev_ns = 0;
  std::int64_t min_delay_arrival_ns = 0;
  std::int64_t arrival_ns = 0;
  std::uint64_t sequence = 0;
  std::uint64_t order = 0;
  InstantSource instant_source = InstantSource::arrival;
  FrameStatus status = FrameStatus::good;
  bool key = false;
};

struct VideoDecoder::Implementation {
  Implementation(const StreamFormat& stream_format, int slice_threads)
      : format(stream_format), threads(slice_threads) {
    open();
  }

  void open();
  void restartAtKeyPicture(const EncodedUnit& unit);

  StreamFormat format;  ///< includes the latest parameter sets
  int threads;
  ffmpeg::CodecContext context;
  ffmpeg::Packet packet = ffmpeg::makePacket();
  std::deque<Pending> pending;
  bool send_failed = false;  ///< a unit was rejected since the last frame
  bool damaged = false;      ///< the decoder reported errors since the last key frame
  bool saw_damage = false;   ///< a damaged unit was decoded since the decoder was opened
};

void VideoDecoder::Implementation::open() {
  const AVCodec* codec = avcodec_find_decoder(ffmpeg::codecId(format.codec));
  if (codec == nullptr) {
    throw std::runtime_error("this FFmpeg has no decoder for " +
                             std::string(avcodec_get_name(ffmpeg::codecId(format.codec))));
  }
  ffmpeg::CodecContext opened(avcodec_alloc_context3(codec));
  if (!opened) throw std::bad_alloc();
  opened->flags |= AV_CODEC_FLAG_LOW_DELAY | AV_CODEC_FLAG_OUTPUT_CORRUPT;
  opened->thread_type = FF_THREAD_SLICE;
  opened->thread_count = threads;
  if (!format.parameter_sets.empty()) {
    AVCodecParameters* parameters = avcodec_parameters_alloc();
    if (parameters == nullptr) throw std::bad_alloc();
    parameters->codec_type = AVMEDIA_TYPE_VIDEO;
    parameters->codec_id = codec->id;
    ffmpeg::setExtradata(*parameters, format.parameter_sets);
    avcodec_parameters_to_context(opened.get(), parameters);
    avcodec_parameters_free(&parameters);
  }
  if (const int error = avcodec_open2(opened.get(), codec, nullptr); error < 0) {
    throw std::runtime_error("cannot start the video decoder: " + ffmpeg::errorText(error));
  }
  context = std::move(opened);
}

/// Opens a new decoder before a key picture if the old one has decoded damaged data. FFmpeg's H.264 decoder
/// keeps coefficients of a truncated picture in its memory and adds them to the first macroblock of the next
/// picture, key or not, without an error.
void VideoDecoder::Implementation::restartAtKeyPicture(const EncodedUnit& unit) {
  try {
    if (saw_damage) open();
    saw_damage = false;
  } catch (const std::runtime_error&) {
    // The parameter sets are damaged: continue with the old decoder.
  }
  std::vector<std::uint8_t> sets = parameterSets(format.codec, unit.data);
  if (unit.status == FrameStatus::good && !sets.empty()) format.parameter_sets = std::move(sets);
}

VideoDecoder::VideoDecoder(const StreamFormat& format, int threads) {
  keepFfmpegQuiet();
  implementation_ = std::make_unique<Implementation>(format, threads);
}

VideoDecoder::~VideoDecoder() = default;

void VideoDecoder::send(const EncodedUnit& unit) {
  Implementation& self = *implementation_;
  if (unit.key) self.restartAtKeyPicture(unit);
  if (unit.status == FrameStatus::damaged) self.saw_damage = true;
  self.pending.push_back({unit.exposure_ns, unit.exposure_stddev_ns, unit.min_delay_arrival_ns,
                          unit.arrival_ns, unit.sequence, unit.order, unit.instant_source, unit.status,
                          unit.key});
  if (self.pending.size() > kMaxPending) self.pending.pop_front();

  // Not reference-counted, so FFmpeg copies the data with the required padding.
  self.packet->data = const_cast<std::uint8_t*>(unit.data.data());  // only read
  self.packet->size = static_cast<int>(unit.data.size());
  self.packet->pts = static_cast<std::int64_t>(unit.sequence);  // returned with the frame
  self.packet->flags = unit.key ? AV_PKT_FLAG_KEY : 0;
  const int error = avcodec_send_packet(self.context.get(), self.packet.get());
  self.packet->data = nullptr;
  self.packet->size = 0;
  if (error < 0) {
    ++failures_;
    self.send_failed = self.saw_damage = true;
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
      self.send_failed = self.saw_damage = true;
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
    frame.exposure_stddev_ns = pending.exposure_stddev_ns;
    frame.min_delay_arrival_ns = pending.min_delay_arrival_ns;
    frame.arrival_ns = pending.arrival_ns;
    frame.decoded_ns = hostNow();
    frame.sequence = pending.sequence;
    frame.order = pending.order;
    frame.instant_source = pending.instant_source;
    frame.status = updateDamage(pending, failed) ? FrameStatus::damaged : FrameStatus::good;
    frame.key_frame = picture->pict_type == AV_PICTURE_TYPE_I;
    frame.storage = picture;
    return frame;
  }
}

void VideoDecoder::finish() {
  avcodec_send_packet(implementation_->context.get(), nullptr);
}

/// Updates the damage state; returns whether this frame is damaged. Damage lasts until a key frame, which is
/// predicted from no other picture, is decoded without an error.
bool VideoDecoder::updateDamage(const Pending& pending, bool decoder_failed) {
  Implementation& self = *implementation_;
  if (pending.key) self.damaged = false;
  if (decoder_failed) self.saw_damage = true;
  if (decoder_failed || (self.send_failed && !pending.key)) self.damaged = true;
  self.send_failed = false;
  return self.damaged || pending.status == FrameStatus::damaged;
}

}  // namespace cartvo::capture
