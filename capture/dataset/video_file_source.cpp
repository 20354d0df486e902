// Decoding of video files through FFmpeg.

#include "capture/dataset/video_file_source.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "capture/codec/ffmpeg.hpp"
#include "capture/codec/ffmpeg_log.hpp"
#include "capture/codec/luma_plane.hpp"
#include "capture/dataset/image_instants.hpp"
#include "capture/dataset/video_file_problem.hpp"
#include "common/exact_text.hpp"
#include "common/files/foreign_format.hpp"
#include "common/input_file.hpp"
#include "common/statistics.hpp"

extern "C" {
#include <libavutil/opt.h>
#include <libavutil/parseutils.h>
}

namespace cartvo::capture {
namespace {

constexpr int kMaxSide = 16384;  // px

/// Whether FFmpeg makes up the time stamps of such files: its readers of raw streams have a frame rate as an
/// option, 25 Hz by default.
bool hasInventedTimes(const AVFormatContext& context) {
  return context.iformat->priv_class != nullptr &&
         av_opt_find(context.priv_data, "framerate", nullptr, 0, 0) != nullptr;
}

/// Indices of the streams that are video, without pictures of the cover.
std::vector<int> videoTracks(const AVFormatContext& context) {
  std::vector<int> tracks;
  for (unsigned i = 0; i < context.nb_streams; ++i) {
    const AVStream& stream = *context.streams[i];
    if (stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
        (stream.disposition & AV_DISPOSITION_ATTACHED_PIC) == 0)
      tracks.push_back(static_cast<int>(i));
  }
  return tracks;
}

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
  VideoView view;
  double header_rate = 0.0;  ///< Hz, by the file's header; 0: unknown
  double frame_rate = 0.0;   ///< Hz; above 0 it replaces the time stamps
  std::string time_note;
  std::shared_ptr<AVFrame> first;  ///< first picture, decoded at the opening
  bool draining = false;
  bool damaged = false;  ///< since the last key picture
  double file_time = 0.0;
  std::uint64_t sequence = 0;
  std::uint64_t undecodable = 0;
  std::atomic<bool> interrupted = false;

  mutable std::mutex mutex;  ///< guards health
  CameraHealth health;

  void open() {
    input = openInput();
    requireSuccess(avformat_find_stream_info(input.get(), nullptr));
    const std::vector<int> tracks = videoTracks(*input);
    if (!view.track) {
      stream = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    } else if (static_cast<std::size_t>(*view.track) < tracks.size()) {
      stream = tracks[static_cast<std::size_t>(*view.track)];
    }
    // FFmpeg opens a file whose index is cut off as one without streams.
    if (stream < 0 && isUnfinishedMp4(file)) requireSuccess(AVERROR_INVALIDDATA);
    if (const std::string format = stream < 0 ? foreignFormat(file) : ""; !format.empty())
      throw std::runtime_error(file.string() + " " + format);
    if (stream < 0) throw std::runtime_error(file.string() + " contains no video");
    header_rate = av_q2d(av_guess_frame_rate(input.get(), input->streams[stream], nullptr));
    openDecoder();
    first = decodePicture();
    chooseTimes();
  }
  ffmpeg::Input openInput() const {
    requireInputFile(file);
    // FFmpeg takes many texts for raw streams.
    if (isTextFile(file)) requireSuccess(AVERROR_INVALIDDATA);
    // Playlists may refer to other files and addresses; allow only this file.
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    AVFormatContext* context = nullptr;
    const std::string url = "file:" + file.string();
    const int opened = avformat_open_input(&context, url.c_str(), nullptr, &options);
    av_dict_free(&options);
    requireSuccess(opened);
    return ffmpeg::Input(context);
  }
  void openDecoder() {
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
    decoder->framerate = {0, 1};  // the decoder sets it from the stream
    requireSuccess(avcodec_open2(decoder.get(), codec, nullptr));
  }
  /// Chooses time stamps or a frame rate. Throws std::runtime_error if the file has neither.
  void chooseTimes() {
    frame_rate = time.frame_rate;
    if (frame_rate > 0.0) return;
    if (!hasInventedTimes(*input)) return requireUsableTimes();
    // The decoder knows the rate that the stream itself declares.
    if (decoder->framerate.num > 0 && decoder->framerate.den > 0) frame_rate = av_q2d(decoder->framerate);
    if (!isPlausibleInterval(frame_rate > 0.0 ? 1.0 / frame_rate : 0.0)) {
      throw std::runtime_error(file.string() +
                               " is a raw stream: nothing in it says how many pictures a second " +
                               "it has. Give the cameras' frame rate by --frame-rate HZ");
    }
    time_note = file.string() + " is a raw stream without time stamps; the " + roundedText(frame_rate, 4) +
                " Hz that it declares are used. If the camera had another rate, give --frame-rate HZ";
  }
  /// Reads the time stamps of the first pictures, and throws std::runtime_error if they stand still or their
  /// intervals are not those of a camera.
  void requireUsableTimes() const {
    constexpr std::size_t kSample = 300;
    const ffmpeg::Input scanned = openInput();
    const ffmpeg::Packet scanned_packet = ffmpeg::makePacket();
    std::vector<std::int64_t> stamps;
    std::size_t pictures = 0;
    while (pictures < kSample && av_read_frame(scanned.get(), scanned_packet.get()) >= 0) {
      const std::int64_t stamp =
          scanned_packet->pts != AV_NOPTS_VALUE ? scanned_packet->pts : scanned_packet->dts;
      if (scanned_packet->stream_index == stream) {
        ++pictures;
        if (stamp != AV_NOPTS_VALUE) stamps.push_back(stamp);
      }
      av_packet_unref(scanned_packet.get());
    }
    if (pictures < 3) return;
    std::sort(stamps.begin(), stamps.end());
    std::vector<double> intervals;
    for (std::size_t i = 1; i < stamps.size(); ++i)
      intervals.push_back(static_cast<double>(stamps[i] - stamps[i - 1]) *
                          av_q2d(input->streams[stream]->time_base));
    const double interval = 2 * stamps.size() > pictures && !intervals.empty() ? medianOf(intervals) : 0.0;
    if (isPlausibleInterval(interval)) return;
    throw std::runtime_error(file.string() + " has no usable time stamps: " +
                             (interval > 0.0 ? "their median interval is " + roundedText(interval, 4) + " s"
                                             : "most pictures have none, or the same") +
                             ". Give the cameras' frame rate by --frame-rate HZ");
  }
  /// Sends the next packet to the decoder, or starts draining it at the end of the file.
  void sendPacket() {
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
  std::shared_ptr<AVFrame> decodePicture() {
    if (first) return std::exchange(first, nullptr);
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
  /// File time of a picture, s.
  double timeOf(const AVFrame& picture) const {
    if (frame_rate > 0.0) return static_cast<double>(sequence) / frame_rate;
    if (picture.best_effort_timestamp != AV_NOPTS_VALUE)
      return static_cast<double>(picture.best_effort_timestamp) * av_q2d(input->streams[stream]->time_base);
    throw std::runtime_error(file.string() +
                             " has a picture without a time stamp; give the cameras' frame rate " +
                             "by --frame-rate HZ");
  }
  /// Damage of the file, for the health; "" if there is none.
  std::string problemAtEnd() const {
    std::string problem;
    if (health.damaged > 0 || undecodable > 0) {
      problem = std::to_string(health.damaged) + " pictures are damaged, " + std::to_string(undecodable) +
                " packets could not be decoded";
    }
    constexpr double kMinMissing_s = 1.0, kMinMissingFraction = 0.1;
    const AVStream& video = *input->streams[stream];
    // Matroska states the duration of the file, not of the stream.
    const double duration = video.duration > 0 ? static_cast<double>(video.duration) * av_q2d(video.time_base)
                                               : 1e-6 * static_cast<double>(input->duration);
    const bool has_duration = duration > 0.0 && frame_rate <= 0.0 &&
                              input->duration_estimation_method != AVFMT_DURATION_FROM_BITRATE;
    if (has_duration && !interrupted && file_time <= time.to) {
      const double start = video.start_time == AV_NOPTS_VALUE
                               ? 0.0
                               : static_cast<double>(video.start_time) * av_q2d(video.time_base);
      const double read = file_time - start;
      if (duration - read > std::max(kMinMissing_s, kMinMissingFraction * duration)) {
        problem += (problem.empty() ? "" : "; ") + std::string("its pictures end after ") +
                   roundedText(read, 4) + " s of the " + roundedText(duration, 4) +
                   " s that its header states: it is cut off or damaged";
      }
    }
    return problem.empty() ? "" : file.string() + ": " + problem;
  }
  void requireSuccess(int result) const {
    if (result >= 0) return;
    throw std::runtime_error(
        "cannot read the video " + file.string() + ": " +
        (result == AVERROR_INVALIDDATA ? videoFileProblem(file) : ffmpeg::errorText(result)));
  }
};

VideoFileSource::VideoFileSource(const std::filesystem::path& file, const VideoFileTime& time,
                                 const VideoView& view)
    : implementation_(std::make_unique<Implementation>()) {
  keepFfmpegQuiet();
  implementation_->file = file;
  implementation_->time = time;
  implementation_->view = view;
  implementation_->open();
}

VideoFileSource::~VideoFileSource() = default;

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
    frame.image = greyPicture(*picture);
    if (!frame.image.empty()) frame.image = partOf(frame.image, self.view.part);
    if (frame.image.empty()) {
      throw std::runtime_error(self.file.string() +
                               " has pictures of a format that cannot be converted; convert it by "
                               "'ffmpeg -i FILE -pix_fmt yuv420p -c:v libx264 -qp 10 FILE.mkv'");
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
  self.health.last_error = self.problemAtEnd();
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

cv::Size VideoFileSource::pictureSize() const {
  const AVCodecParameters& parameters = *implementation_->input->streams[implementation_->stream]->codecpar;
  return {parameters.width, parameters.height};
}

int VideoFileSource::tracks() const {
  return static_cast<int>(videoTracks(*implementation_->input).size());
}

std::string VideoFileSource::timeNote() const {
  return implementation_->time_note;
}

std::size_t VideoFileSource::expectedPictures() const {
  const Implementation& self = *implementation_;
  const AVStream& stream = *self.input->streams[self.stream];
  if (stream.nb_frames > 0) return static_cast<std::size_t>(stream.nb_frames);
  if (self.input->duration <= 0 || self.header_rate <= 0.0) return 0;
  return static_cast<std::size_t>(1e-6 * static_cast<double>(self.input->duration) * self.header_rate);
}

std::int64_t VideoFileSource::creationNs() const {
  const AVDictionaryEntry* entry = av_dict_get(implementation_->input->metadata, "creation_time", nullptr, 0);
  std::int64_t creation_us = 0;
  if (entry == nullptr || av_parse_time(&creation_us, entry->value, 0) < 0) return 0;
  return creation_us * 1000;
}

}  // namespace cartvo::capture
