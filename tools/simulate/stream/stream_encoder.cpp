// H.264 encoder of the simulated cameras: libx264 through libavcodec.
#include "tools/simulate/stream/stream_encoder.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

#include "common/image_size.hpp"

namespace cartvo::simulate {
namespace {

struct AvDelete {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
template <class T>
using AvPointer = std::unique_ptr<T, AvDelete>;

void require(int result, const char* what) {
  if (result >= 0) return;
  char reason[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(result, reason, sizeof reason);
  throw std::runtime_error(std::string("H.264 encoder: ") + what + ": " + reason);
}

void check(const EncoderSettings& settings, cv::Size size, double frame_rate) {
  if (size.width < 16 || size.height < 16 || size.width % 2 != 0 || size.height % 2 != 0) {
    throw std::invalid_argument("pictures of " + sizeText(size) +
                                " cannot be encoded: both sides must be even and at least 16 pixels");
  }
  if (!(frame_rate > 0.0 && frame_rate <= 240.0))
    throw std::invalid_argument("the frame rate must be in (0, 240] Hz");
  if (settings.bitrate_kbps < 50 || settings.bitrate_kbps > 200'000) {
    throw std::invalid_argument("the bit rate must be between 50 and 200000 kbit/s");
  }
  if (!(settings.key_frame_interval > 0.0 && settings.key_frame_interval <= 60.0)) {
    throw std::invalid_argument("the key-frame interval must be in (0, 60] s");
  }
  if (settings.slices < 1 || settings.slices > 16)
    throw std::invalid_argument("slices per picture must be 1 to 16");
}

AvPointer<AVCodecContext> openEncoder(const EncoderSettings& settings, cv::Size size, double frame_rate) {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (codec == nullptr)
    throw std::runtime_error("libavcodec has no encoder libx264: install Debian's libavcodec-extra");
  AvPointer<AVCodecContext> context(avcodec_alloc_context3(codec));
  if (!context) throw std::bad_alloc();

  context->log_level_offset = AV_LOG_ERROR;  // errors only
  context->width = size.width;
  context->height = size.height;
  context->pix_fmt = AV_PIX_FMT_YUVJ420P;
  context->color_range = AVCOL_RANGE_JPEG;
  context->framerate = av_d2q(frame_rate, 100'000);
  context->time_base = av_inv_q(context->framerate);
  context->gop_size = std::max(1, static_cast<int>(std::lround(settings.key_frame_interval * frame_rate)));
  context->keyint_min = context->gop_size;
  context->max_b_frames = 0;
  context->refs = 1;
  context->slices = settings.slices;
  context->thread_count = 1;
  context->bit_rate = std::int64_t{settings.bitrate_kbps} * 1000;
  context->rc_max_rate = context->bit_rate;
  context->rc_buffer_size = settings.bitrate_kbps * 1000 / 2;

  require(av_opt_set(context->priv_data, "preset", "medium", 0), "preset");
  require(av_opt_set(context->priv_data, "tune", "zerolatency", 0), "tune");
  require(av_opt_set(context->priv_data, "profile", "main", 0), "profile");
  require(av_opt_set(context->priv_data, "x264-params", "scenecut=0:repeat-headers=1:sliced-threads=0", 0),
          "parameters");
  require(avcodec_open2(context.get(), codec, nullptr), "cannot open libx264");
  return context;
}

}  // namespace

std::string encoderKey(const EncoderSettings& settings) {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  return "h264 main medium zerolatency " + std::to_string(settings.bitrate_kbps) +
         " kbit/s, key frame every " + std::to_string(settings.key_frame_interval) + " s, slices " +
         std::to_string(settings.slices) + ", " + (codec != nullptr ? codec->long_name : "none") + " " +
         std::to_string(avcodec_version());
}

class StreamEncoder::Implementation {
 public:
  Implementation(const EncoderSettings& settings, cv::Size size, double frame_rate)
      : context_(openEncoder(settings, size, frame_rate)),
        frame_(av_frame_alloc()),
        packet_(av_packet_alloc()) {
    if (!frame_ || !packet_) throw std::bad_alloc();
    frame_->format = context_->pix_fmt;
    frame_->width = size.width;
    frame_->height = size.height;
    frame_->color_range = context_->color_range;
    require(av_frame_get_buffer(frame_.get(), 0), "no memory for a picture");
  }

  EncodedPicture encode(const cv::Mat& image) {
    if (image.type() != CV_8UC1 || image.cols != frame_->width || image.rows != frame_->height) {
      throw std::invalid_argument("a picture to encode must be grey, 8 bit, " +
                                  sizeText({frame_->width, frame_->height}));
    }
    fill(image);
    frame_->pts = next_pts_++;
    require(avcodec_send_frame(context_.get(), frame_.get()), "a picture was rejected");
    require(avcodec_receive_packet(context_.get(), packet_.get()), "no packet for a picture");
    EncodedPicture picture{.data = {packet_->data, packet_->data + packet_->size},
                           .key_frame = (packet_->flags & AV_PKT_FLAG_KEY) != 0};
    av_packet_unref(packet_.get());
    return picture;
  }

 private:
  void fill(const cv::Mat& image) {
    require(av_frame_make_writable(frame_.get()), "no memory for a picture");
    for (int row = 0; row < image.rows; ++row) {
      std::memcpy(frame_->data[0] + std::ptrdiff_t{row} * frame_->linesize[0], image.ptr(row),
                  static_cast<std::size_t>(image.cols));
    }
    for (int plane = 1; plane <= 2; ++plane) {
      std::memset(frame_->data[plane], 128,
                  static_cast<std::size_t>(frame_->linesize[plane]) * (image.rows / 2));
    }
  }

  AvPointer<AVCodecContext> context_;
  AvPointer<AVFrame> frame_;
  AvPointer<AVPacket> packet_;
  std::int64_t next_pts_ = 0;
};

StreamEncoder::StreamEncoder(const EncoderSettings& settings, cv::Size size, double frame_rate) {
  check(settings, size, frame_rate);
  implementation_ = std::make_unique<Implementation>(settings, size, frame_rate);
}

StreamEncoder::~StreamEncoder() = default;

EncodedPicture StreamEncoder::encode(const cv::Mat& image) {
  return implementation_->encode(image);
}

}  // namespace cartvo::simulate
