#include "capture/loss_detector.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tests/capture/encoded_sequence.hpp"

namespace cartvo {
namespace {

const cv::Size kSize(160, 120);

std::vector<EncodedUnit> camera(const std::string& options = "") {
  return test::encodeSequence(VideoCodec::h264, kSize, 60, 20, options);
}

TEST(LossDetector, AnUnbrokenStreamIsGood) {
  for (const char* options : {"", "ref=4", "slices=3", "cabac=1:ref=2"}) {
    LossDetector detector({VideoCodec::h264, {}});
    for (const EncodedUnit& unit : camera(options)) {
      EXPECT_EQ(detector.inspect(unit.data, false, 0), FrameStatus::good) << options << " " << unit.sequence;
    }
  }
}

TEST(LossDetector, AMissingReferenceDamagesAllUpToTheNextKeyFrame) {
  LossDetector detector({VideoCodec::h264, {}});
  for (const EncodedUnit& unit : camera()) {
    if (unit.sequence == 27) continue;
    const bool damaged = unit.sequence > 27 && unit.sequence < 40;
    EXPECT_EQ(detector.inspect(unit.data, false, 0), damaged ? FrameStatus::damaged : FrameStatus::good)
        << unit.sequence;
  }
}

TEST(LossDetector, WhatTheReceiverMissedDamagesAllUpToTheNextKeyFrame) {
  LossDetector detector({VideoCodec::h264, {}});
  for (const EncodedUnit& unit : camera()) {
    const bool damaged = unit.sequence >= 5 && unit.sequence < 20;
    EXPECT_EQ(detector.inspect(unit.data, unit.sequence == 5, 0),
              damaged ? FrameStatus::damaged : FrameStatus::good);
  }
}

TEST(LossDetector, InH265AGapInTimeCounts) {
  LossDetector detector({VideoCodec::h265, {}});
  for (const EncodedUnit& unit : test::encodeSequence(VideoCodec::h265, kSize, 30, 10, "")) {
    const bool damaged = unit.sequence >= 4 && unit.sequence < 10;
    EXPECT_EQ(detector.inspect(unit.data, false, unit.sequence == 4 ? 1 : 0),
              damaged ? FrameStatus::damaged : FrameStatus::good)
        << unit.sequence;
  }
}

TEST(LossDetector, GarbageIsNoReasonToCrash) {
  LossDetector detector({VideoCodec::h264, {0, 0, 0, 1, 0x67}});
  for (std::uint8_t type = 0; type < 32; ++type) {
    for (std::size_t size = 0; size < 12; ++size) {
      std::vector<std::uint8_t> data = {0, 0, 1, type};
      data.insert(data.end(), size, static_cast<std::uint8_t>(17 * type));
      detector.inspect(data, false, 0);
    }
  }
}

}  // namespace
}  // namespace cartvo
