// Detection of lost pictures in H.264 and H.265 streams.

#include "capture/rtsp/loss_detector.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/capture/encoded_sequence.hpp"

namespace cartvo::capture {
namespace {

const cv::Size kSize(160, 120);

std::vector<EncodedUnit> camera(const std::string& options = "") {
  return test::encodeSequence(VideoCodec::h264, kSize, 60, 20, options);
}

TEST(LossDetector, AcceptsUnbrokenStream) {
  for (const char* options : {"", "ref=4", "slices=3", "cabac=1:ref=2"}) {
    LossDetector detector({VideoCodec::h264, {}});
    for (const EncodedUnit& unit : camera(options)) {
      EXPECT_EQ(detector.inspect(unit.data, false).status, FrameStatus::good)
          << options << " " << unit.sequence;
    }
  }
}

TEST(LossDetector, MarksPicturesAfterMissingReferenceUpToKeyFrame) {
  LossDetector detector({VideoCodec::h264, {}});
  for (const EncodedUnit& unit : camera()) {
    if (unit.sequence == 27) continue;
    const bool damaged = unit.sequence > 27 && unit.sequence < 40;
    EXPECT_EQ(detector.inspect(unit.data, false).status, damaged ? FrameStatus::damaged : FrameStatus::good)
        << unit.sequence;
  }
}

TEST(LossDetector, MarksPicturesAfterLostDataUpToKeyFrame) {
  LossDetector detector({VideoCodec::h264, {}});
  for (const EncodedUnit& unit : camera()) {
    const bool damaged = unit.sequence >= 5 && unit.sequence < 20;
    EXPECT_EQ(detector.inspect(unit.data, unit.sequence == 5).status,
              damaged ? FrameStatus::damaged : FrameStatus::good);
  }
}

TEST(LossDetector, MarksH265PicturesAfterLostDataUpToKeyFrame) {
  LossDetector detector({VideoCodec::h265, {}});
  for (const EncodedUnit& unit : test::encodeSequence(VideoCodec::h265, kSize, 30, 10, "")) {
    const bool damaged = unit.sequence >= 4 && unit.sequence < 10;
    EXPECT_EQ(detector.inspect(unit.data, unit.sequence == 4).status,
              damaged ? FrameStatus::damaged : FrameStatus::good)
        << unit.sequence;
  }
}

/// Whether each picture from `first` on can begin the stream, and is good, as "A" or "a" and "+" or "-".
std::string beginnings(const std::vector<EncodedUnit>& units, std::size_t first) {
  LossDetector detector({VideoCodec::h264, {}});
  std::string text;
  for (std::size_t i = first; i < units.size(); ++i) {
    const PictureInspection inspection = detector.inspect(units[i].data, false);
    text += inspection.is_access_point ? 'A' : 'a';
    text += inspection.status == FrameStatus::good ? '+' : '-';
  }
  return text;
}

TEST(LossDetector, BeginsAtRecoveryPointsAndCompletesGradualRefresh) {
  // The encoder refreshes a part of each picture, with a recovery point for each cycle of ten pictures.
  const auto units = test::encodeSequence(VideoCodec::h264, kSize, 60, 10, "intra-refresh=1");
  const std::string text = beginnings(units, 5);
  const std::size_t access = text.find('A');
  const std::size_t good = text.find('+');
  ASSERT_NE(access, std::string::npos) << text;
  ASSERT_NE(good, std::string::npos) << text;
  EXPECT_GE(good - access, 10U) << text;
  EXPECT_EQ(text.find('-', good), std::string::npos) << "no picture after the refresh is damaged: " << text;
}

TEST(LossDetector, MarksPicturesBeforeFirstAccessPoint) {
  const std::string text = beginnings(camera(), 5);
  EXPECT_EQ(text.substr(0, 34), "a-a-a-a-a-a-a-a-a-a-a-a-a-a-a-A+a+");
}

/// NAL unit with start code from a string of '0' and '1', with emulation prevention bytes (ITU-T
/// H.264 7.4.1.1).
std::vector<std::uint8_t> nalUnit(std::uint8_t header, std::string bits) {
  bits.resize((bits.size() + 7) / 8 * 8, '0');
  std::vector<std::uint8_t> data = {0, 0, 1, header};
  int zeros = 0;
  for (std::size_t i = 0; i < bits.size(); i += 8) {
    const auto byte = static_cast<std::uint8_t>(std::stoi(bits.substr(i, 8), nullptr, 2));
    if (zeros >= 2 && byte <= 3) {
      data.push_back(3);
      zeros = 0;
    }
    zeros = byte == 0 ? zeros + 1 : 0;
    data.push_back(byte);
  }
  return data;
}

TEST(LossDetector, IgnoresParameterSetsOutOfRange) {
  const std::string profile_and_level = "010000101100000000001010", zero = "1";
  const std::string largest = std::string(31, '0') + '1' + std::string(31, '1');  // 2^32 - 2, Exp-Golomb
  // As log2_max_frame_num_minus4 it would overflow to 2 bits.
  LossDetector detector(
      {VideoCodec::h264, nalUnit(0x67, profile_and_level + zero + largest + zero + zero + zero + "01")});
  for (const char* frame_num : {"00", "10"}) {
    const std::vector<std::uint8_t> slice = nalUnit(0x65, zero + zero + zero + frame_num + "111111");
    EXPECT_EQ(detector.inspect(slice, false).status, FrameStatus::good);
  }

  // A scaling list of the high profile with an equally large first difference.
  const std::string high_profile = "011001000000000000001010";
  LossDetector with_scaling_list({VideoCodec::h264, nalUnit(0x67, high_profile + zero + "010" + zero + zero +
                                                                      "0" + "1" + "1" + largest)});
  EXPECT_EQ(with_scaling_list.inspect(nalUnit(0x65, "11110000"), false).status, FrameStatus::good);
}

TEST(LossDetector, SurvivesInvalidData) {
  LossDetector detector({VideoCodec::h264, {0, 0, 0, 1, 0x67}});
  for (std::uint8_t type = 0; type < 32; ++type) {
    for (std::size_t size = 0; size < 12; ++size) {
      std::vector<std::uint8_t> data = {0, 0, 1, type};
      data.insert(data.end(), size, static_cast<std::uint8_t>(17 * type));
      detector.inspect(data, false);
    }
  }
}

}  // namespace
}  // namespace cartvo::capture
