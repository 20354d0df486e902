// H.264 and H.265 decoding through FFmpeg.

#include "capture/codec/video_decoder.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>
#include <vector>

#include "capture/codec/ffmpeg.hpp"
#include "capture/codec/ffmpeg_log.hpp"
#include "capture/codec/luma_plane.hpp"
#include "capture/codec/nal_units.hpp"
#include "capture/codec/refresh_detector.hpp"
#include "common/host_clock.hpp"

namespace cartvo::capture {
namespace {

/// Maximum number of frames in the decoder (H.264's largest decoded picture buffer).
constexpr std::size_t kMaxPending = 64;

/// Longest step back of RTP time that is the order of B-frames, 1/90000 s: 16 pictures at 10 Hz.
constexpr std::int64_t kMaxReordering = 144'000;

std::shared_ptr<AVFrame> makeFrame() {
  std::shared_ptr<AVFrame> frame(av_frame_alloc(), [](AVFrame* f) { av_frame_free(&f); });
  if (!frame) throw std::bad_alloc();
  return frame;
}

}  // namespace

/// Attributes of a unit in the decoder, for its frame.
struct VideoDecoder::Pending : FrameTimestamps {
  FrameStatus status = FrameStatus::good;
  bool is_refreshed = false;  ///< no earlier damage affects it
};

struct VideoDecoder::Implementation {
  Implementation(const StreamFormat& stream_format, int slice_threads, std::int64_t pixels)
      : format(stream_format), threads(slice_threads), max_pixels(pixels), refreshes(stream_format) {
    open();
  }

  void open() {
    const AVCodec* codec = avcodec_find_decoder(ffmpeg::codecId(format.codec));
    if (codec == nullptr) {
      throw std::runtime_error("this FFmpeg has no decoder for " +
                               std::string(avcodec_get_name(ffmpeg::codecId(format.codec))));
    }
    ffmpeg::CodecContext opened(avcodec_alloc_context3(codec));
    if (!opened) throw std::bad_alloc();
    opened->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
    // Without this flag FFmpeg puts pictures into their order, which delays them.
    if (!reorders) opened->flags |= AV_CODEC_FLAG_LOW_DELAY;
    opened->max_pixels = max_pixels;
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
      if (!format.parameter_sets.empty()) {  // they are damaged: the stream repeats them
        format.parameter_sets.clear();
        return open();
      }
      throw std::runtime_error("cannot start the video decoder: " + ffmpeg::errorText(error));
    }
    context = std::move(opened);
  }
  /// Opens a new decoder before a key picture if the stream turned out to have B-frames, or if the old one
  /// has decoded damaged data: FFmpeg's H.264 decoder keeps coefficients of a truncated picture in its memory
  /// and adds them to the first macroblock of the next picture, key or not, without an error.
  void restartAtKeyPicture(const EncodedUnit& unit) {
    try {
      const bool begins_reordering = reorders && (context->flags & AV_CODEC_FLAG_LOW_DELAY) != 0;
      if (begins_reordering) drain();
      if (saw_damage || begins_reordering) open();
      saw_damage = false;
    } catch (const std::runtime_error&) {
      // The parameter sets are damaged: continue with the old decoder.
    }
    std::vector<std::uint8_t> sets = parameterSets(format.codec, unit.data);
    if (unit.status == FrameStatus::good && !sets.empty()) format.parameter_sets = std::move(sets);
  }
  /// Notes the size of a picture that was not decoded, if it exceeds the limit.
  void noteRefusedSize(const EncodedUnit& unit) {
    const std::unique_ptr<AVCodecParameters, void (*)(AVCodecParameters*)> parameters(
        avcodec_parameters_alloc(), [](AVCodecParameters* p) { avcodec_parameters_free(&p); });
    if (!parameters) throw std::bad_alloc();
    parameters->codec_type = AVMEDIA_TYPE_VIDEO;
    parameters->codec_id = ffmpeg::codecId(format.codec);
    if (!format.parameter_sets.empty()) ffmpeg::setExtradata(*parameters, format.parameter_sets);
    ffmpeg::readPictureSize(*parameters, unit.data);
    const cv::Size size(parameters->width, parameters->height);
    if (static_cast<std::int64_t>(size.width) * size.height > max_pixels) refused_size = size;
  }
  /// Takes the pictures that the decoder holds, before it is replaced.
  void drain() {
    avcodec_send_packet(context.get(), nullptr);
    for (;;) {
      std::shared_ptr<AVFrame> picture = makeFrame();
      if (avcodec_receive_frame(context.get(), picture.get()) < 0) break;
      drained.push_back(std::move(picture));
    }
  }

  StreamFormat format;  ///< includes the latest parameter sets
  int threads;
  std::int64_t max_pixels;
  cv::Size refused_size;
  ffmpeg::CodecContext context;
  ffmpeg::Packet packet = ffmpeg::makePacket();
  std::deque<Pending> pending;
  std::deque<std::shared_ptr<AVFrame>> drained;  ///< pictures of the decoder before this one
  RefreshDetector refreshes;
  std::optional<std::int64_t> latest_pts;
  bool reorders = false;     ///< pictures are sent in another order than they were taken in
  bool send_failed = false;  ///< a unit was rejected since the last frame
  bool damaged = false;      ///< the decoder reported errors since the last refresh
  bool saw_damage = false;   ///< a damaged unit was decoded since the decoder was opened
};

VideoDecoder::VideoDecoder(const StreamFormat& format, int threads, std::int64_t max_pixels) {
  keepFfmpegQuiet();
  implementation_ = std::make_unique<Implementation>(format, threads, max_pixels);
}

VideoDecoder::~VideoDecoder() = default;

void VideoDecoder::send(const EncodedUnit& unit) {
  Implementation& self = *implementation_;
  const std::int64_t latest = self.latest_pts.value_or(unit.pts);
  if (unit.pts < latest && latest - unit.pts < kMaxReordering) self.reorders = true;
  self.latest_pts = unit.pts < latest - kMaxReordering ? unit.pts : std::max(latest, unit.pts);
  if (unit.key) self.restartAtKeyPicture(unit);
  const PictureRefresh refresh = self.refreshes.inspect(splitNalUnits(self.format.codec, unit.data));
  if (unit.status == FrameStatus::damaged) self.saw_damage = true;
  self.pending.push_back({unit, unit.status, refresh.is_complete});
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
    self.refreshes.restart();
    if (unit.key) self.noteRefusedSize(unit);
  } else {
    self.refused_size = {};
  }
}

std::optional<Frame> VideoDecoder::receive() {
  Implementation& self = *implementation_;
  for (;;) {
    std::shared_ptr<AVFrame> picture = makeFrame();
    int error = 0;
    if (self.drained.empty()) {
      error = avcodec_receive_frame(self.context.get(), picture.get());
    } else {
      picture = std::move(self.drained.front());
      self.drained.pop_front();
    }
    if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return std::nullopt;
    if (error < 0) {
      ++failures_;
      self.send_failed = self.saw_damage = true;
      self.refreshes.restart();
      return std::nullopt;
    }
    const auto sequence = static_cast<std::uint64_t>(picture->pts);
    const cv::Mat luma = lumaPlane(*picture);
    const auto found = std::find_if(self.pending.begin(), self.pending.end(),
                                    [&](const Pending& p) { return p.sequence == sequence; });
    if (found == self.pending.end() || luma.empty()) {
      ++failures_;
      continue;
    }
    const Pending pending = *found;
    self.pending.erase(found);

    // FFmpeg marks H.264 pictures as corrupt up to an IDR or recovery point; RefreshDetector knows more.
    const bool is_corrupt =
        (picture->flags & AV_FRAME_FLAG_CORRUPT) != 0 && self.format.codec != VideoCodec::h264;
    const bool failed = is_corrupt || picture->decode_error_flags != 0;
    Frame frame;
    frame.image = luma;
    static_cast<FrameTimestamps&>(frame) = pending;
    frame.decoded_ns = hostNow();
    frame.status = updateDamage(pending, failed) ? FrameStatus::damaged : FrameStatus::good;
    frame.key_frame = picture->pict_type == AV_PICTURE_TYPE_I;
    frame.storage = picture;
    return frame;
  }
}

void VideoDecoder::finish() {
  avcodec_send_packet(implementation_->context.get(), nullptr);
}

/// Updates the damage state; returns whether this frame is damaged. Damage lasts until a refresh that is
/// decoded without an error.
bool VideoDecoder::updateDamage(const Pending& pending, bool decoder_failed) {
  Implementation& self = *implementation_;
  if (pending.is_refreshed) self.damaged = false;
  if (decoder_failed) {
    self.saw_damage = self.damaged = true;
    self.refreshes.restart();
  }
  if (self.send_failed && !pending.is_refreshed) self.damaged = true;
  self.send_failed = false;
  return self.damaged || pending.status == FrameStatus::damaged;
}

cv::Size VideoDecoder::refusedSize() const {
  return implementation_->refused_size;
}

bool VideoDecoder::hasParameterSets() const {
  return !implementation_->format.parameter_sets.empty();
}

bool VideoDecoder::reorders() const {
  return implementation_->reorders;
}

}  // namespace cartvo::capture
