// Synthetic pictures, encoded through FFmpeg.

#include "tests/support/capture/encoded_sequence.hpp"

#include <cmath>
#include <stdexcept>

#include "capture/codec/ffmpeg.hpp"
#include "capture/codec/ffmpeg_log.hpp"
#include "capture/codec/video_decoder.hpp"

extern "C" {
#include <libavutil/opt.h>
}

namespace cartvo::test {
namespace {

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t kPeriod_ns = 50'000'000;

void require(bool condition, const char* what) {
  if (!condition) throw std::runtime_error(what);
}

}  // namespace

cv::Mat movingPicture(cv::Size size, int index) {
  cv::Mat picture(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double u = x + 1.5 * index;
      const double value =
          128.0 + 60.0 * std::sin(0.09 * u) * std::cos(0.13 * y) + 40.0 * std::sin(0.41 * u + 0.3 * y);
      picture.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(value);
    }
  }
  return picture;
}

std::vector<capture::EncodedUnit> encodeSequence(capture::VideoCodec codec, cv::Size size, int count,
                                                 int key_interval, const std::string& encoder_options,
                                                 int b_frames) {
  const bool h264 = codec == capture::VideoCodec::h264;
  capture::keepFfmpegQuiet();
  const AVCodec* encoder = avcodec_find_encoder_by_name(h264 ? "libx264" : "libx265");
  require(encoder != nullptr, "FFmpeg has no encoder");
  const capture::ffmpeg::CodecContext context(avcodec_alloc_context3(encoder));
  context->width = size.width;
  context->height = size.height;
  context->pix_fmt = AV_PIX_FMT_YUV420P;
  context->time_base = {1, 20};
  context->gop_size = key_interval;
  context->max_b_frames = b_frames;
  context->thread_count = 1;
  av_opt_set(context->priv_data, "preset", "ultrafast", 0);
  if (b_frames == 0) av_opt_set(context->priv_data, "tune", "zerolatency", 0);
  const std::string common =
      h264 ? "sliced-threads=0:scenecut=0" : "log-level=none:scenecut=0:repeat-headers=1";
  av_opt_set(context->priv_data, h264 ? "x264-params" : "x265-params",
             (encoder_options.empty() ? common : common + ":" + encoder_options).c_str(), 0);
  require(avcodec_open2(context.get(), encoder, nullptr) == 0, "cannot open the encoder");

  AVFrame* frame = av_frame_alloc();
  frame->format = AV_PIX_FMT_YUV420P;
  frame->width = size.width;
  frame->height = size.height;
  av_frame_get_buffer(frame, 0);
  const capture::ffmpeg::Packet packet = capture::ffmpeg::makePacket();
  std::vector<capture::EncodedUnit> units;
  const auto receive = [&] {
    while (avcodec_receive_packet(context.get(), packet.get()) == 0) {
      capture::EncodedUnit unit;
      unit.data.assign(packet->data, packet->data + packet->size);
      unit.key = (packet->flags & AV_PKT_FLAG_KEY) != 0;
      unit.sequence = units.size();
      unit.pts = packet->pts * 4500;
      unit.exposure_ns = kStart_ns + packet->pts * kPeriod_ns;
      unit.arrival_ns = unit.exposure_ns + 12'345'678;
      unit.instant_source = capture::InstantSource::sender_report;
      units.push_back(std::move(unit));
      av_packet_unref(packet.get());
    }
  };
  for (int i = 0; i < count; ++i) {
    av_frame_make_writable(frame);
    movingPicture(size, i).copyTo(
        cv::Mat(size, CV_8UC1, frame->data[0], static_cast<std::size_t>(frame->linesize[0])));
    for (int plane = 1; plane < 3; ++plane) {
      cv::Mat((size.height + 1) / 2, (size.width + 1) / 2, CV_8UC1, frame->data[plane],
              static_cast<std::size_t>(frame->linesize[plane]))
          .setTo(128);
    }
    frame->pts = i;
    require(avcodec_send_frame(context.get(), frame) == 0, "cannot encode");
    receive();
  }
  avcodec_send_frame(context.get(), nullptr);
  receive();
  av_frame_free(&frame);
  require(units.size() == static_cast<std::size_t>(count), "the encoder held pictures back");
  return units;
}

std::uint64_t digest(const cv::Mat& image) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x)
      hash = (hash ^ image.at<std::uint8_t>(y, x)) * 1099511628211ULL;
  }
  return hash;
}

std::set<std::uint64_t> digestsOf(capture::VideoCodec codec, const std::vector<capture::EncodedUnit>& units) {
  capture::VideoDecoder decoder({codec, {}}, 1);
  std::set<std::uint64_t> digests;
  for (const capture::EncodedUnit& unit : units) {
    decoder.send(unit);
    while (const std::optional<capture::Frame> frame = decoder.receive())
      digests.insert(digest(frame->image));
  }
  return digests;
}

}  // namespace cartvo::test
