// Decoding of intact and of damaged streams.

#include "capture/codec/video_decoder.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/support/capture/encoded_sequence.hpp"

namespace cartvo::capture {
namespace {

const cv::Size kSize(320, 200);

TEST(VideoDecoder, ReturnsEachPictureWithAttributesOfItsUnit) {
  for (const VideoCodec codec : {VideoCodec::h264, VideoCodec::h265}) {
    VideoDecoder decoder({codec, {}}, 1);
    for (const EncodedUnit& unit : test::encodeSequence(codec, kSize, 30, 10, "")) {
      decoder.send(unit);
      const std::optional<Frame> frame = decoder.receive();
      ASSERT_TRUE(frame) << "picture " << unit.sequence << " was held back";
      EXPECT_EQ(frame->sequence, unit.sequence);
      EXPECT_EQ(frame->exposure_ns, unit.exposure_ns);
      EXPECT_EQ(frame->arrival_ns, unit.arrival_ns);
      EXPECT_EQ(frame->instant_source, InstantSource::sender_report);
      EXPECT_EQ(frame->status, FrameStatus::good);
      EXPECT_EQ(frame->key_frame, unit.sequence % 10 == 0);
      EXPECT_FALSE(decoder.receive());
    }
  }
}

TEST(VideoDecoder, PutsBFramesInOrderFromTheNextKeyPictureOn) {
  for (const VideoCodec codec : {VideoCodec::h264, VideoCodec::h265}) {
    VideoDecoder decoder({codec, {}}, 1);
    std::vector<std::int64_t> exposures;
    std::size_t frames = 0;
    const auto receive = [&] {
      while (const std::optional<Frame> frame = decoder.receive()) {
        ++frames;
        if (frame->sequence < 12) continue;
        exposures.push_back(frame->exposure_ns);
        EXPECT_EQ(frame->status, FrameStatus::good);
      }
    };
    const auto units = test::encodeSequence(codec, kSize, 48, 12, "b-adapt=0:open-gop=0", 2);
    for (const EncodedUnit& unit : units) {
      decoder.send(unit);
      receive();
    }
    decoder.finish();
    receive();
    EXPECT_TRUE(decoder.reorders());
    EXPECT_EQ(frames, units.size()) << "none is lost";
    EXPECT_EQ(exposures.size(), 36U);
    for (std::size_t i = 1; i < exposures.size(); ++i)
      EXPECT_EQ(exposures[i] - exposures[i - 1], 50'000'000) << i;
  }
}

TEST(VideoDecoder, RefusesLargePicturesAndTellsTheirSize) {
  VideoDecoder decoder({VideoCodec::h264, {}}, 1, kSize.area() - 1);
  for (const EncodedUnit& unit : test::encodeSequence(VideoCodec::h264, kSize, 3, 3, "")) {
    decoder.send(unit);
    EXPECT_FALSE(decoder.receive());
  }
  EXPECT_EQ(decoder.refusedSize(), kSize);
}

TEST(VideoDecoder, DoesWithoutDamagedParameterSets) {
  for (const VideoCodec codec : {VideoCodec::h264, VideoCodec::h265}) {
    const std::uint8_t header = codec == VideoCodec::h264 ? 0x67 : 0x42;
    VideoDecoder decoder({codec, {0, 0, 0, 1, header, 1, 2, 3, 4, 0, 0, 0, 1, 0x44, 1, 9}}, 1);
    for (const EncodedUnit& unit : test::encodeSequence(codec, kSize, 2, 2, "")) {
      decoder.send(unit);
      EXPECT_TRUE(decoder.receive());
    }
  }
}

TEST(VideoDecoder, BeginsAtRecoveryPoint) {
  VideoDecoder decoder({VideoCodec::h264, {}}, 1);
  std::size_t good = 0;
  std::size_t sent = 0;
  for (EncodedUnit unit : test::encodeSequence(VideoCodec::h264, kSize, 60, 10, "intra-refresh=1")) {
    if (unit.sequence < 5) continue;
    unit.status = unit.sequence < 25 ? FrameStatus::damaged : FrameStatus::good;  // as LossDetector has it
    decoder.send(unit);
    while (const std::optional<Frame> frame = decoder.receive())
      good += frame->status == FrameStatus::good ? 1U : 0U;
    sent += unit.status == FrameStatus::good ? 1U : 0U;
  }
  EXPECT_EQ(good, sent);
}

TEST(VideoDecoder, ImageIsLumaPlaneWithoutCopy) {
  VideoDecoder decoder({VideoCodec::h264, {}}, 1);
  Frame last;
  for (const EncodedUnit& unit : test::encodeSequence(VideoCodec::h264, kSize, 12, 12, "qp=4")) {
    decoder.send(unit);
    if (std::optional<Frame> frame = decoder.receive()) last = *frame;
  }
  ASSERT_EQ(last.image.size(), kSize);
  EXPECT_EQ(last.image.u, nullptr) << "cv::Mat owns the memory: it was copied";
  EXPECT_NE(last.storage, nullptr);
  EXPECT_LT(cv::norm(last.image, test::movingPicture(kSize, 11), cv::NORM_L1) / kSize.area(), 2.0);
}

TEST(VideoDecoder, FrameOutlivesDecoder) {
  Frame kept;
  std::uint64_t before = 0;
  {
    VideoDecoder decoder({VideoCodec::h264, {}}, 1);
    for (const EncodedUnit& unit : test::encodeSequence(VideoCodec::h264, kSize, 20, 10, "")) {
      decoder.send(unit);
      std::optional<Frame> frame = decoder.receive();
      if (frame && unit.sequence == 3) {
        kept = *frame;
        before = test::digest(kept.image);
      }
    }
  }
  EXPECT_EQ(test::digest(kept.image), before);
}

TEST(VideoDecoder, SliceThreadsGiveSamePictures) {
  const std::vector<EncodedUnit> units = test::encodeSequence(VideoCodec::h264, kSize, 10, 5, "slices=4");
  VideoDecoder one({VideoCodec::h264, {}}, 1);
  VideoDecoder two({VideoCodec::h264, {}}, 2);
  for (const EncodedUnit& unit : units) {
    one.send(unit);
    two.send(unit);
    const std::optional<Frame> a = one.receive();
    const std::optional<Frame> b = two.receive();
    ASSERT_TRUE(a && b);
    EXPECT_EQ(test::digest(a->image), test::digest(b->image));
  }
}

TEST(VideoDecoder, MarksFramesAfterTruncatedPictureUpToKeyFrame) {
  VideoDecoder decoder({VideoCodec::h264, {}}, 1);
  for (EncodedUnit unit : test::encodeSequence(VideoCodec::h264, kSize, 40, 20,
                                               "bitrate=2000:vbv-maxrate=2000:vbv-bufsize=400")) {
    if (unit.sequence == 5) unit.data.resize(unit.data.size() / 2);
    decoder.send(unit);
    const std::optional<Frame> frame = decoder.receive();
    if (!frame) continue;
    const bool damaged = unit.sequence >= 5 && unit.sequence < 20;
    EXPECT_EQ(frame->status, damaged ? FrameStatus::damaged : FrameStatus::good) << unit.sequence;
  }
}

TEST(VideoDecoder, TruncatedPictureLeavesNoTraceInNextKeyPicture) {
  const std::vector<EncodedUnit> units =
      test::encodeSequence(VideoCodec::h264, cv::Size(160, 120), 10, 5, "crf=36");
  const auto fifth_picture = [&](const std::vector<EncodedUnit>& sent) {
    VideoDecoder decoder({VideoCodec::h264, {}}, 1);
    std::uint64_t digest = 0;
    for (const EncodedUnit& unit : sent) {
      decoder.send(unit);
      while (const std::optional<Frame> frame = decoder.receive()) {
        if (frame->sequence == 5 && frame->status == FrameStatus::good) digest = test::digest(frame->image);
      }
    }
    return digest;
  };
  const std::uint64_t whole = fifth_picture(units);
  for (const std::size_t cut : {0U, 4U}) {
    for (std::size_t size = units[cut].data.size() - 1; size > 100; size -= 41) {
      std::vector<EncodedUnit> sent = units;
      sent[cut].data.resize(size);
      for (std::size_t i = cut; i < 5; ++i)
        sent[i].status = FrameStatus::damaged;
      EXPECT_EQ(fifth_picture(sent), whole) << "picture " << cut << " cut after " << size << " bytes";
    }
  }
}

TEST(VideoDecoder, MarksFrameOfDamagedUnit) {
  VideoDecoder decoder({VideoCodec::h264, {}}, 1);
  for (EncodedUnit unit : test::encodeSequence(VideoCodec::h264, kSize, 4, 4, "")) {
    if (unit.sequence == 2) unit.status = FrameStatus::damaged;
    decoder.send(unit);
    const std::optional<Frame> frame = decoder.receive();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->status == FrameStatus::damaged, unit.sequence == 2);
  }
}

TEST(VideoDecoder, CountsInvalidUnitsAsFailures) {
  VideoDecoder decoder({VideoCodec::h264, {}}, 1);
  EncodedUnit garbage;
  garbage.data.assign(2000, 0x5a);
  for (std::uint64_t i = 0; i < 100; ++i) {
    garbage.sequence = i;
    decoder.send(garbage);
    EXPECT_FALSE(decoder.receive());
  }
  EXPECT_GT(decoder.failures(), 0U);
}

}  // namespace
}  // namespace cartvo::capture
