// Decoding of video files through FFmpeg.

#include "capture/dataset/video_file_source.hpp"

#include <atomic>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "capture/codec/ffmpeg.hpp"
#include "capture/codec/ffmpeg_log.hpp"
#include "capture/codec/luma_plane.hpp"

extern "C" {
#include <libavutil/parseutils.h>
}

namespace cartvo::capture {
namespace {

constexpr int kMaxSide = 16384;  // px

std::shared_ptr<AVFrame> makeFrame() {
  std::shared_ptr<AVFrame> frame(av_frame_alloc(), [](AVFrame* f) { av_frame_free(&f); });
  if (!frame) throw std::bad_alloc();
  return frame;
}

}  // namespace

struct VideoFileSource::Implementation {
  std::filesystem::path file;
  VideoFileTime time;
  ffmpeg::Input input;
  ffmpeg::CodecContext decoder;
  ffmpeg::Packet packet = ffmpeg::makePacket();
  int stream = -1;
  double frame_rate = 0.0;  ///< by the file's header; used if there are no time stamps
  bool draining = false;
  bool damaged = false;  ///< since the last key picture
  double file_time = 0.0;
  std::uint64_t sequence = 0;
  std::uint64_t undecodable = 0;
  std::atomic<bool> interrupted = false;

  mutable std::mutex mutex;  ///< guards health
  CameraHealth health;

  void open();
  void openDecoder();
  void sendPacket();
  std::shared_ptr<AVFrame> decodePicture();
  double timeOf(const AVFrame& picture) const;
  void requireSuccess(int result) const;
};

VideoFileSource::VideoFileSource(const std::filesystem::path& file, const VideoFileTime& time)
    : implementation_(std::make_unique<Implementation>()) {
  keepFfmpegQuiet();
  implementation_->file = file;
  implementation_->time = time;
  implementation_->open();
}

VideoFileSource::~VideoFileSource() = default;

void VideoFileSource::Implementation::requireSuccess(int result) const {
  if (result < 0)
    throw std::runtime_error("cannot read the video " + file.string() + ": " + ffmpeg::errorText(result));
}

void VideoFileSource::Implementation::open() {
  if (!std::filesystem::is_regular_file(file))
    throw std::runtime_error(file.string() + " is not a file; expected a video");
  // Playlists may refer to other files and addresses; allow only this file.
  AVDictionary* options = nullptr;
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  AVFormatContext* context = nullptr;
  const std::string url = "file:" + file.string();
  const int opened = avformat_open_input(&context, url.c_str(), nullptr, &options);
  av_dict_free(&options);
  requireSuccess(opened);
  input.reset(context);
  requireSuccess(avformat_find_stream_info(context, nullptr));
  stream = av_find_best_stream(context, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (stream < 0) throw std::runtime_error(file.string() + " contains no video");
  frame_rate = av_q2d(av_guess_frame_rate(context, context->streams[stream], nullptr));
  openDecoder();
}

void VideoFileSource::Implementation::openDecoder() {
  const AVCodecParameters& parameters = *input->streams[stream]->codecpar;
  const AVCodec* codec = avcodec_find_decoder(parameters.codec_id);
  if (codec == nullptr) {
    throw std::runtime_error(file.string() + " contains " + avcodec_get_name(parameters.codec_id) +
                             " video, for which this FFmpeg has no decoder");
  }
  if (parameters.width > kMaxSide || parameters.height > kMaxSide)
    throw std::runtime_error(file.string() + " contains pictures larger than 16384 px");
  decoder.reset(avcodec_alloc_context3(codec));
  if (!decoder) throw std::bad_alloc();
  requireSuccess(avcodec_parameters_to_context(decoder.get(), &parameters));
  decoder->pkt_timebase = input->streams[stream]->time_base;
  decoder->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
  decoder->thread_count = 1;
  requireSuccess(avcodec_open2(decoder.get(), codec, nullptr));
}

/// Sends the next packet to the decoder, or starts draining it at the end of the file.
void VideoFileSource::Implementation::sendPacket() {
  for (;;) {
    av_packet_unref(packet.get());
    if (av_read_frame(input.get(), packet.get()) < 0) {
      draining = true;
      avcodec_send_packet(decoder.get(), nullptr);
      return;
    }
    if (packet->stream_index != stream) continue;
    if (avcodec_send_packet(decoder.get(), packet.get()) >= 0) return;
    ++undecodable;
    damaged = true;
  }
}

/// Decodes the next picture; null at the end.
std::shared_ptr<AVFrame> VideoFileSource::Implementation::decodePicture() {
  std::shared_ptr<AVFrame> picture = makeFrame();
  while (!interrupted) {
    const int result = avcodec_receive_frame(decoder.get(), picture.get());
    if (result == 0) return picture;
    if (draining) return nullptr;
    if (result != AVERROR(EAGAIN)) {
      ++undecodable;
      damaged = true;
    }
    sendPacket();
  }
  return nullptr;
}

/// File time of a picture, s. Throws std::runtime_error if the file has neither time stamps nor a frame rate.
double VideoFileSource::Implementation::timeOf(const AVFrame& picture) const {
  if (picture.best_effort_timestamp != AV_NOPTS_VALUE)
    return static_cast<double>(picture.best_effort_timestamp) * av_q2d(input->streams[stream]->time_base);
  if (frame_rate > 0.0) return static_cast<double>(sequence) / frame_rate;
  throw std::runtime_error(
      file.string() +
      " has neither time stamps nor a frame rate; put it into a container that has them, for "
      "example by 'ffmpeg -framerate 25 -i FILE -c copy FILE.mkv'");
}

ReadOutcome VideoFileSource::read(Frame& frame, std::chrono::milliseconds /*timeout*/) {
  Implementation& self = *implementation_;
  while (const std::shared_ptr<AVFrame> picture = self.decodePicture()) {
    self.file_time = self.timeOf(*picture);
    const std::uint64_t sequence = self.sequence++;
    if (self.file_time > self.time.to) break;
    if (picture->key_frame != 0) self.damaged = false;
    if ((picture->flags & AV_FRAME_FLAG_CORRUPT) != 0 || picture->decode_error_flags != 0)
      self.damaged = true;
    if (self.file_time < self.time.from) continue;
    frame = {};
    frame.image = lumaPlane(*picture);
    if (frame.image.empty()) {
      throw std::runtime_error(
          self.file.string() +
          " has pictures without a luma plane; convert it by 'ffmpeg -i FILE -pix_fmt yuv420p "
          "-c:v libx264 -qp 10 FILE.mkv'");
    }
    frame.key_frame = picture->pict_type == AV_PICTURE_TYPE_I;
    frame.storage = picture;
    frame.exposure_ns = self.time.origin_ns +
                        std::llround(1e9 * (self.time.offset + (1.0 + self.time.skew) * self.file_time));
    frame.exposure_stddev_ns = std::llround(1e9 * self.time.stddev);
    frame.arrival_ns = frame.decoded_ns = frame.exposure_ns;
    frame.sequence = sequence;
    frame.instant_source = InstantSource::file;
    frame.status = self.damaged ? FrameStatus::damaged : FrameStatus::good;
    const std::lock_guard lock(self.mutex);
    self.health.state = CameraState::streaming;
    ++self.health.frames;
    if (self.damaged) ++self.health.damaged;
    return ReadOutcome::frame;
  }
  const std::lock_guard lock(self.mutex);
  self.health.state = CameraState::ended;
  if (self.health.damaged > 0 || self.undecodable > 0) {
    self.health.last_error = self.file.string() + ": " + std::to_string(self.health.damaged) +
                             " pictures are damaged, " + std::to_string(self.undecodable) +
                             " packets could not be decoded";
  }
  return ReadOutcome::ended;
}

CameraHealth VideoFileSource::health() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->health;
}

void VideoFileSource::interrupt() noexcept {
  implementation_->interrupted = true;
}

double VideoFileSource::fileTime() const {
  return implementation_->file_time;
}

std::size_t VideoFileSource::expectedPictures() const {
  const Implementation& self = *implementation_;
  const AVStream& stream = *self.input->streams[self.stream];
  if (stream.nb_frames > 0) return static_cast<std::size_t>(stream.nb_frames);
  if (self.input->duration <= 0 || self.frame_rate <= 0.0) return 0;
  return static_cast<std::size_t>(1e-6 * static_cast<double>(self.input->duration) * self.frame_rate);
}

std::int64_t VideoFileSource::creationNs() const {
  const AVDictionaryEntry* entry = av_dict_get(implementation_->input->metadata, "creation_time", nullptr, 0);
  std::int64_t creation_us = 0;
  if (entry == nullptr || av_parse_time(&creation_us, entry->value, 0) < 0) return 0;
  return creation_us * 1000;
}

}  // namespace cartvo::capture
