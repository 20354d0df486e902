// Tests of the schedule of pictures: lead-in, then content, without a gap or a step back in time.
#include "tools/simulate/server/frame_schedule.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace cartvo::simulate {
namespace {

constexpr double kFrameRate = 10.0;
constexpr std::int64_t kPeriod_ns = 100'000'000;
constexpr std::int64_t kSwitchedOn_ns = 5'000'000'000;

/// A stream with a lead-in of two pictures and three content pictures, the first `offset_ns` after the start.
std::shared_ptr<const EncodedStream> stream(std::int64_t offset_ns) {
  EncodedStream stream;
  stream.frame_rate = kFrameRate;
  for (int i = 0; i < 2; ++i)
    stream.lead_in.push_back({.instant_ns = i * kPeriod_ns});
  for (int i = 0; i < 3; ++i)
    stream.units.push_back({.instant_ns = i * kPeriod_ns + offset_ns});
  return std::make_shared<const EncodedStream>(stream);
}

std::vector<std::int64_t> nextInstants(FrameSchedule& schedule, int count) {
  std::vector<std::int64_t> instants;
  for (; count > 0 && schedule.next(); --count) {
    instants.push_back(schedule.next()->instant_ns);
    schedule.advance();
  }
  return instants;
}

TEST(FrameSchedule, RepeatsLeadInUntilContentStarts) {
  const auto pictures = stream(0);
  FrameSchedule schedule(pictures, kSwitchedOn_ns, 0);
  for (int i = 0; i < 7; ++i) {
    ASSERT_EQ(schedule.next()->unit, &pictures->lead_in[static_cast<std::size_t>(i) % 2]);
    ASSERT_EQ(schedule.next()->instant_ns, kSwitchedOn_ns + i * kPeriod_ns);
    schedule.advance();
  }
}

TEST(FrameSchedule, ContinuesFromLeadInToContentWithoutGap) {
  for (const std::int64_t offset : {std::int64_t{0}, kPeriod_ns / 4, -kPeriod_ns / 4}) {
    const auto pictures = stream(offset);
    FrameSchedule schedule(pictures, kSwitchedOn_ns, 0);
    schedule.startContent(nextFrameInstant(kSwitchedOn_ns, kFrameRate, kSwitchedOn_ns + 250'000'000));
    const std::vector<std::int64_t> instants = nextInstants(schedule, 100);
    ASSERT_EQ(instants.size(), 6U) << "three lead-in pictures and three content pictures";
    for (std::size_t i = 1; i < instants.size(); ++i)
      EXPECT_EQ(instants[i] - instants[i - 1], kPeriod_ns) << i << " with offset " << offset;
    EXPECT_EQ(instants.back(), kSwitchedOn_ns + 5 * kPeriod_ns + offset);
  }
}

TEST(FrameSchedule, StaysMonotonicWhenContentStartsBetweenTwoPictures) {
  for (std::int64_t shift = 0; shift < kPeriod_ns; shift += 7'000'000) {
    FrameSchedule schedule(stream(0), kSwitchedOn_ns, 0);
    schedule.startContent(kSwitchedOn_ns + 3 * kPeriod_ns + shift);
    const std::vector<std::int64_t> instants = nextInstants(schedule, 100);
    for (std::size_t i = 1; i < instants.size(); ++i)
      EXPECT_GE(instants[i] - instants[i - 1], kPeriod_ns / 2) << i << " with shift " << shift;
  }
}

TEST(FrameSchedule, EndsAfterContentOrRepeatsIt) {
  FrameSchedule once(stream(0), kSwitchedOn_ns, 0);
  once.startContent(kSwitchedOn_ns);
  EXPECT_EQ(nextInstants(once, 100).size(), 3U);
  EXPECT_FALSE(once.next());

  FrameSchedule repeated(stream(0), kSwitchedOn_ns, 3 * kPeriod_ns);
  repeated.startContent(kSwitchedOn_ns);
  const std::vector<std::int64_t> instants = nextInstants(repeated, 8);
  ASSERT_EQ(instants.size(), 8U);
  for (std::size_t i = 1; i < instants.size(); ++i)
    EXPECT_EQ(instants[i] - instants[i - 1], kPeriod_ns);
}

TEST(FrameSchedule, IgnoresASecondStart) {
  FrameSchedule schedule(stream(0), kSwitchedOn_ns, 0);
  schedule.startContent(kSwitchedOn_ns);
  schedule.startContent(kSwitchedOn_ns + 100 * kPeriod_ns);
  const std::vector<std::int64_t> instants = nextInstants(schedule, 1);
  ASSERT_FALSE(instants.empty());
  EXPECT_EQ(instants.front(), kSwitchedOn_ns);
}

TEST(FrameSchedule, RejectsStreamWithoutPictures) {
  EXPECT_THROW(FrameSchedule(std::make_shared<const EncodedStream>(), 0, 0), std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::simulate
