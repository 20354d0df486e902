// H.264 in MP4, by FFmpeg and libx264.
#include "tools/replay/video/mp4_writer.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}
#include <opencv2/imgproc.hpp>

#include "capture/codec/ffmpeg_log.hpp"
#include "common/atomic_file.hpp"

namespace cartvo {
namespace {

constexpr int kTicksPerSecond = 90'000;

struct AvDelete {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFormatContext* output) const {
    if (output->pb != nullptr) avio_closep(&output->pb);
    avformat_free_context(output);
  }
};
template <class T>
using AvPointer = std::unique_ptr<T, AvDelete>;

/// Throws std::runtime_error unless the file's folder exists.
const std::filesystem::path& withFolder(const std::filesystem::path& file) {
  if (file.has_parent_path() && !std::filesystem::is_directory(file.parent_path()))
    throw std::runtime_error(file.string() + ": cannot be written: its folder does not exist");
  return file;
}

}  // namespace

class Mp4Writer::Implementation {
 public:
  explicit Implementation(const std::filesystem::path& file)
      : file_(file), codec_(avcodec_find_encoder_by_name("libx264")), unfinished_(withFolder(file)) {
    if (codec_ == nullptr)
      throw std::runtime_error(file_.string() +
                               ": libavcodec has no encoder libx264: install Debian's "
                               "libavcodec-extra");
    capture::keepFfmpegQuiet();
  }

  void add(const cv::Mat& picture, std::int64_t time_ns) {
    if (!encoder_) open(picture.size());
    if (picture.cols != encoder_->width || picture.rows != encoder_->height)
      throw std::runtime_error(file_.string() + ": the pictures of the video differ in size");
    advance(time_ns);
    fill(picture);
    frame_->pts = ticks_;
    require(avcodec_send_frame(encoder_.get(), frame_.get()));
    writePackets();
  }

  void finish() {
    if (!encoder_) throw std::runtime_error(file_.string() + ": there is no picture for the video");
    require(avcodec_send_frame(encoder_.get(), nullptr));
    writePackets();
    require(av_write_trailer(output_.get()));
    require(avio_closep(&output_->pb));
    unfinished_.commit();
  }

 private:
  void require(int result) const {
    if (result >= 0) return;
    char reason[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(result, reason, sizeof reason);
    throw std::runtime_error(file_.string() + ": the video cannot be written: " + reason);
  }

  void open(cv::Size size) {
    encoder_.reset(avcodec_alloc_context3(codec_));
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    AVFormatContext* output = nullptr;
    require(avformat_alloc_output_context2(&output, nullptr, "mp4", unfinished_.openPath().c_str()));
    output_.reset(output);
    if (!encoder_ || !frame_ || !packet_) throw std::bad_alloc();
    encoder_->log_level_offset = AV_LOG_ERROR;  // errors only
    encoder_->width = size.width;
    encoder_->height = size.height;
    encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder_->color_range = AVCOL_RANGE_MPEG;
    encoder_->colorspace = AVCOL_SPC_SMPTE170M;  // as OpenCV converts
    encoder_->time_base = {1, kTicksPerSecond};
    encoder_->max_b_frames = 0;
    encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    require(av_opt_set(encoder_->priv_data, "preset", "veryfast", 0));
    require(av_opt_set(encoder_->priv_data, "crf", "23", 0));
    require(avcodec_open2(encoder_.get(), codec_, nullptr));
    AVStream* stream = avformat_new_stream(output, nullptr);
    if (stream == nullptr) throw std::bad_alloc();
    require(avcodec_parameters_from_context(stream->codecpar, encoder_.get()));
    stream->time_base = encoder_->time_base;
    require(avio_open(&output->pb, unfinished_.openPath().c_str(), AVIO_FLAG_WRITE));
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "+faststart", 0);
    const int result = avformat_write_header(output, &options);
    av_dict_free(&options);
    require(result);
    frame_->format = encoder_->pix_fmt;
    frame_->width = size.width;
    frame_->height = size.height;
    require(av_frame_get_buffer(frame_.get(), 0));
  }

  /// Moves ticks_ to the time of the next picture.
  void advance(std::int64_t time_ns) {
    constexpr std::int64_t kMaxStep_ns = 5'000'000'000, kGap_ns = 1'000'000'000, kMinStep_ns = 1'000'000;
    if (last_ns_) {
      std::int64_t step_ns = time_ns - *last_ns_;
      if (step_ns > kMaxStep_ns) step_ns = kGap_ns;
      since_first_ns_ += std::max(step_ns, kMinStep_ns);
    }
    last_ns_ = time_ns;
    ticks_ = av_rescale(since_first_ns_, kTicksPerSecond, 1'000'000'000);
  }

  void fill(const cv::Mat& picture) {
    require(av_frame_make_writable(frame_.get()));
    cv::cvtColor(picture, yuv_, cv::COLOR_BGR2YUV_I420);
    const std::uint8_t* from = yuv_.ptr();
    for (int plane = 0; plane < 3; ++plane) {
      const int width = plane == 0 ? picture.cols : picture.cols / 2;
      const int height = plane == 0 ? picture.rows : picture.rows / 2;
      for (int row = 0; row < height; ++row, from += width)
        std::copy(from, from + width, frame_->data[plane] + std::ptrdiff_t{row} * frame_->linesize[plane]);
    }
  }

  void writePackets() {
    AVStream* stream = output_->streams[0];
    for (;;) {
      const int result = avcodec_receive_packet(encoder_.get(), packet_.get());
      if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
      require(result);
      packet_->stream_index = 0;
      av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream->time_base);
      require(av_interleaved_write_frame(output_.get(), packet_.get()));
    }
  }

  std::filesystem::path file_;
  const AVCodec* codec_;
  AtomicFileWriter unfinished_;
  AvPointer<AVCodecContext> encoder_;
  AvPointer<AVFrame> frame_;
  AvPointer<AVPacket> packet_;
  AvPointer<AVFormatContext> output_;
  cv::Mat yuv_;
  std::optional<std::int64_t> last_ns_;
  std::int64_t since_first_ns_ = 0, ticks_ = 0;
};

Mp4Writer::Mp4Writer(const std::filesystem::path& file)
    : implementation_(std::make_unique<Implementation>(file)) {}
Mp4Writer::~Mp4Writer() = default;

void Mp4Writer::add(const cv::Mat& picture, std::int64_t time_ns) {
  implementation_->add(picture, time_ns);
}

void Mp4Writer::finish() {
  implementation_->finish();
}

}  // namespace cartvo
