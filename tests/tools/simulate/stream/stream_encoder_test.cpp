// Tests of the H.264 encoder and of encodeContent, by decoding the streams. Tests of the cache of encoded
// streams: round trip, damaged files, limit.
#include "tools/simulate/stream/stream_encoder.hpp"

#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

extern "C" {
#include <libavcodec/avcodec.h>
}

#include "support/pattern_content.hpp"
#include "support/temporary_folder.hpp"
#include "tools/simulate/stream/encode_content.hpp"
#include "tools/simulate/stream/stream_cache.hpp"
#include "tools/simulate/stream/stream_file.hpp"

namespace cartvo::simulate {
namespace {

namespace fs = std::filesystem;

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

EncodedStream smallStream(std::uint8_t value) {
  EncodedStream stream;
  stream.size = {160, 120};
  stream.frame_rate = 18.0;
  stream.bytes.assign(1000, value);
  stream.lead_in = {{.instant_ns = 0, .begin = 0, .size = 400, .key_frame = true}};
  stream.units = {{.instant_ns = 7, .begin = 400, .size = 600, .key_frame = true}};
  return stream;
}

EncodedPair smallPair() {
  return {.left = smallStream(1), .right = smallStream(2)};
}

TEST(StreamCache, LoadsTheStoredStreams) {
  const test::TemporaryFolder folder;
  const StreamCache cache(folder / "cache", 1'000'000);
  EXPECT_FALSE(cache.load("drive"));
  cache.store("drive", smallPair());
  EXPECT_EQ(cache.load("drive"), smallPair());
  EXPECT_FALSE(cache.load("another drive"));
}

TEST(StreamCache, RemovesDamagedFile) {
  const test::TemporaryFolder folder;
  const StreamCache cache(folder.path(), 1'000'000);
  const fs::path file = cache.fileFor("drive");
  for (const int position : {0, 60, 900, -3}) {
    cache.store("drive", smallPair());
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
        .seekp(position, position < 0 ? std::ios::end : std::ios::beg)
        .put('\x7f');
    EXPECT_FALSE(cache.load("drive")) << "byte " << position;
    EXPECT_FALSE(fs::exists(file));
  }
  cache.store("drive", smallPair());
  fs::resize_file(file, 700);
  EXPECT_FALSE(cache.load("drive"));
}

TEST(StreamCache, RemovesLeastRecentlyUsedFiles) {
  const test::TemporaryFolder folder;
  const StreamCache cache(folder.path(), 2 * streamFileContents(smallPair(), "1").size() + 10);
  const auto age = [&cache](const char* key, int hours) {
    fs::last_write_time(cache.fileFor(key), fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  cache.store("1", smallPair());
  age("1", 3);
  cache.store("2", smallPair());
  age("2", 2);
  EXPECT_TRUE(cache.load("1"));  // now 2 is the least recently used
  cache.store("3", smallPair());
  EXPECT_TRUE(cache.load("1"));
  EXPECT_FALSE(cache.load("2"));
  EXPECT_TRUE(cache.load("3"));
}

TEST(StreamCache, RendersADriveOnceAndRemovesTheLeastRecentlyUsedOne) {
  const test::TemporaryFolder folder;
  const StreamCache cache(folder.path(), 10'000);
  int rendered = 0;
  const auto render = [&rendered](const fs::path& path) {
    ++rendered;
    fs::create_directories(path / "image_0");
    std::ofstream(path / "image_0" / "000000.png") << std::string(8000, 'x');
  };
  const fs::path drive = cache.driveFolder("drive", render);
  EXPECT_EQ(cache.driveFolder("drive", render), drive);
  EXPECT_EQ(rendered, 1);
  EXPECT_TRUE(fs::exists(drive / "image_0" / "000000.png"));

  fs::last_write_time(drive, fs::file_time_type::clock::now() - std::chrono::hours(1));
  cache.store("streams", smallPair());
  EXPECT_FALSE(fs::exists(drive)) << "8000 bytes and those of the streams are too many";
  EXPECT_TRUE(cache.load("streams"));
}

}  // namespace
}  // namespace cartvo::simulate
