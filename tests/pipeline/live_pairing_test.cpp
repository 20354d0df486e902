// Measured periods, and sentences about frames that do not pair.

#include "pipeline/live_pairing.hpp"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cartvo::pipeline {
namespace {

using capture::CameraSide;
using testing::HasSubstr;

constexpr std::int64_t kPeriod_ns = 50'000'000;

capture::Frame frameOf(std::int64_t exposure_ns, std::int64_t arrival_ns) {
  capture::Frame frame;
  frame.image = cv::Mat::zeros(4, 4, CV_8UC1);
  frame.exposure_ns = exposure_ns;
  frame.arrival_ns = arrival_ns;
  return frame;
}

/// Both cameras' frames of some seconds, which arrive each period.
class TwoCameras {
 public:
  TwoCameras() : pairing(capture::PairSynchroniserSettings(), cv::Size(4, 4)) {}

  using Change = std::function<void(std::int64_t index, capture::Frame& right)>;

  void run(double seconds, const Change& change) {
    const std::int64_t end = index_ + static_cast<std::int64_t>(seconds * 1e9) / kPeriod_ns;
    for (; index_ < end; ++index_) {
      const std::int64_t now_ns = index_ * kPeriod_ns;
      pairing.push(CameraSide::left, frameOf(now_ns, now_ns));
      capture::Frame right = frameOf(now_ns, now_ns);
      change(index_, right);
      pairing.push(CameraSide::right, std::move(right));
    }
  }

  LivePairing pairing;

 private:
  std::int64_t index_ = 1;
};

void unchanged(std::int64_t /*index*/, capture::Frame& /*right*/) {}

TEST(LivePairing, SaysWhyNothingPairs) {
  struct Fault {
    const char* problem;
    TwoCameras::Change change;
  };
  const Fault faults[] = {
      {"the right camera's latest is 3600000 ms after the left one's",
       [](std::int64_t, capture::Frame& right) { right.exposure_ns += 3'600'000'000'000; }},
      {"the right camera's are damaged",
       [](std::int64_t, capture::Frame& right) { right.status = capture::FrameStatus::damaged; }},
      {"the right camera's are not in the order of their times",
       [](std::int64_t index, capture::Frame& right) { right.exposure_ns = -(index % 2); }}};
  for (const Fault& fault : faults) {
    TwoCameras cameras;
    cameras.run(3.0, unchanged);
    cameras.run(4.0, fault.change);
    EXPECT_EQ(cameras.pairing.pairingProblem(), "") << "not yet";
    cameras.run(2.0, fault.change);
    EXPECT_THAT(cameras.pairing.pairingProblem(), HasSubstr("no pictures can be paired: "));
    EXPECT_THAT(cameras.pairing.pairingProblem(), HasSubstr(fault.problem));
    cameras.run(2.0, unchanged);
    EXPECT_EQ(cameras.pairing.pairingProblem(), "") << "over: " << fault.problem;
  }
}

TEST(LivePairing, SaysThatPicturesArriveInBursts) {
  const auto arriving = [](std::int64_t together, std::int64_t pauses) {
    return [=](std::int64_t index, capture::Frame& right) {
      const std::int64_t begin = index / together * together;
      const bool is_held_back = pauses == 0 || index < pauses * together;
      if (is_held_back) right.arrival_ns = (begin + together - 1) * kPeriod_ns + (index - begin) * 1'000'000;
    };
  };
  TwoCameras bursts, paused, even;
  bursts.run(6.0, arriving(8, 0));
  paused.run(3.0, arriving(40, 1));
  even.run(6.0, unchanged);
  EXPECT_THAT(bursts.pairing.pairingProblem(), HasSubstr("the right camera's pictures arrive "));
  EXPECT_EQ(paused.pairing.pairingProblem(), "") << "once is no habit";
  EXPECT_EQ(even.pairing.pairingProblem(), "");
}

TEST(LivePairing, SaysSoAlsoBeforeTheFirstPair) {
  TwoCameras cameras;
  cameras.run(6.0, [](std::int64_t, capture::Frame& right) { right.exposure_ns += 3'600'000'000'000; });
  EXPECT_THAT(cameras.pairing.pairingProblem(), HasSubstr("no pictures can be paired: "));
}

TEST(LivePairing, CameraThatSendsNothingIsNotUnpaired) {
  TwoCameras cameras;
  cameras.run(3.0, unchanged);
  for (std::int64_t i = 60; i < 300; ++i)
    cameras.pairing.push(CameraSide::left, frameOf(i * kPeriod_ns, i * kPeriod_ns));
  EXPECT_EQ(cameras.pairing.pairingProblem(), "");
}

TEST(LivePairing, PeriodIsTheSlowerMeasure) {
  TwoCameras in_another_unit;
  in_another_unit.run(4.0, [](std::int64_t index, capture::Frame& right) { right.exposure_ns = index; });
  EXPECT_EQ(in_another_unit.pairing.periods().by_exposures[1], 1);
  EXPECT_EQ(in_another_unit.pairing.periods().ofPairsNs(), kPeriod_ns);

  TwoCameras of_one_burst;
  of_one_burst.run(4.0, [](std::int64_t, capture::Frame& right) { right.arrival_ns = 4'000'000'000; });
  EXPECT_EQ(of_one_burst.pairing.periods().by_arrivals[1], 0);
  EXPECT_EQ(of_one_burst.pairing.periods().ofPairsNs(), kPeriod_ns);

  TwoCameras reconnected;
  reconnected.run(4.0, [](std::int64_t index, capture::Frame& right) {
    if (index > 40) right.arrival_ns += 60'000'000'000;
  });
  EXPECT_EQ(reconnected.pairing.periods().by_arrivals[1], kPeriod_ns) << "the gap is no period";
}

}  // namespace
}  // namespace cartvo::pipeline
