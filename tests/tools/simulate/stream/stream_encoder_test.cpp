// Tests of the H.264 encoder and of encodeContent, by decoding the streams.
#include "tools/simulate/stream/stream_encoder.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

extern "C" {
#include <libavcodec/avcodec.h>
}

#include "support/pattern_content.hpp"
#include "tools/simulate/stream/encode_content.hpp"

namespace cartvo::simulate {
namespace {

/// A decoded picture with its type (I or P) and value range.
struct DecodedPicture {
  cv::Mat luma;
  char type = '?';
  AVColorRange range = AVCOL_RANGE_UNSPECIFIED;
};

// Decodes `units` of a stream.
std::vector<DecodedPicture> decode(const EncodedStream& stream, const std::vector<AccessUnit>& units) {
  AVCodecContext* context = avcodec_alloc_context3(avcodec_find_decoder(AV_CODEC_ID_H264));
  context->thread_count = 1;
  avcodec_open2(context, nullptr, nullptr);
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  std::vector<DecodedPicture> pictures;
  const auto drain = [&] {
    while (avcodec_receive_frame(context, frame) == 0) {
      const cv::Mat luma(frame->height, frame->width, CV_8UC1, frame->data[0],
                         static_cast<std::size_t>(frame->linesize[0]));
      pictures.push_back({luma.clone(), av_get_picture_type_char(frame->pict_type), frame->color_range});
    }
  };
  for (const AccessUnit& unit : units) {
    const auto bytes = stream.data(unit);
    av_new_packet(packet, static_cast<int>(bytes.size()));
    std::copy(bytes.begin(), bytes.end(), packet->data);
    avcodec_send_packet(context, packet);
    av_packet_unref(packet);
    drain();
  }
  avcodec_send_packet(context, nullptr);
  drain();
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&context);
  return pictures;
}

std::vector<DecodedPicture> decode(const EncodedStream& stream) {
  return decode(stream, stream.units);
}

double peakSignalToNoise(const cv::Mat& a, const cv::Mat& b) {
  const double rms = cv::norm(a, b, cv::NORM_L2) / std::sqrt(static_cast<double>(a.total()));
  return 20.0 * std::log10(255.0 / rms);
}

TEST(StreamEncoder, HasNoBFramesAndAKeyFrameEachInterval) {
  const test::PatternContent content({.pairs = 25});
  const EncodedPair pair = encodeContent(content, {.bitrate_kbps = 4000}, {});
  const std::vector<DecodedPicture> decoded = decode(pair.left);

  ASSERT_EQ(decoded.size(), 25U);
  cv::Mat left;
  cv::Mat right;
  for (std::size_t index = 0; index < decoded.size(); ++index) {
    content.images(static_cast<int>(index), left, right);
    EXPECT_GT(peakSignalToNoise(decoded[index].luma, left), 38.0) << "picture " << index;
    EXPECT_EQ(decoded[index].type, index % 20 == 0 ? 'I' : 'P') << "picture " << index;
    EXPECT_EQ(pair.left.units[index].key_frame, index % 20 == 0) << "picture " << index;
    EXPECT_EQ(decoded[index].range, AVCOL_RANGE_JPEG);
  }
}

class MovingPatternContent : public test::PatternContent {
 public:
  using PatternContent::PatternContent;
  bool startsAtStandstill() const override { return false; }
};

TEST(StreamEncoder, LeadInShowsFirstPictureOnlyIfContentStartsAtStandstill) {
  const test::PatternSettings settings{.pairs = 2};
  const EncodedPair standing = encodeContent(test::PatternContent(settings), {}, {});
  const EncodedPair moving = encodeContent(MovingPatternContent(settings), {}, {});
  const std::vector<DecodedPicture> decoded = decode(standing.left);
  ASSERT_FALSE(decoded.empty());
  const cv::Mat first = decoded.front().luma;
  for (const DecodedPicture& picture : decode(standing.left, standing.left.lead_in))
    EXPECT_GT(peakSignalToNoise(picture.luma, first), 38.0);
  for (const DecodedPicture& picture : decode(moving.left, moving.left.lead_in)) {
    double darkest = 0.0, brightest = 0.0;
    cv::minMaxLoc(picture.luma, &darkest, &brightest);
    EXPECT_LT(brightest - darkest, 3.0) << "a blank lead-in";
  }
  EXPECT_EQ(moving.left.lead_in.size(), standing.left.lead_in.size());
  const std::vector<DecodedPicture> decoded_moving = decode(moving.left);
  ASSERT_FALSE(decoded_moving.empty());
  EXPECT_GT(peakSignalToNoise(decoded_moving.front().luma, first), 38.0);
}

TEST(StreamEncoder, KeepsTheBitRate) {
  const EncodedPair pair =
      encodeContent(test::PatternContent({.pairs = 60, .speed = 3.0}), {.bitrate_kbps = 600}, {});
  std::uint64_t bytes = 0;
  for (const AccessUnit& unit : pair.left.units)
    bytes += unit.size;
  EXPECT_LT(static_cast<double>(bytes) * 8.0 / 3.0, 1.2 * 600e3);  // 60 pictures at 20 Hz: 3 s
}

TEST(StreamEncoder, IsDeterministic) {
  const test::PatternContent content({.pairs = 5, .offset_s = 0.01});
  EXPECT_EQ(encodeContent(content, {}, {}), encodeContent(content, {}, {}));
}

TEST(StreamEncoder, RejectsInvalidSizesAndRates) {
  EXPECT_THROW(StreamEncoder({}, {641, 480}, 18.0), std::invalid_argument);
  EXPECT_THROW(StreamEncoder({}, {640, 480}, 0.0), std::invalid_argument);
  EXPECT_THROW(StreamEncoder({.bitrate_kbps = 1}, {640, 480}, 18.0), std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::simulate
