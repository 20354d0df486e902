#include "capture/exposure_clock.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

constexpr std::int64_t kStart_us = 1'700'000'000'000'000;
constexpr std::int64_t kWrap_us = 47'721'858'844;  // 2^32 / 90000 s

/// A camera at 18 fps whose instants are exact; the relation is what FFmpeg reports.
struct Camera {
  static std::int64_t pts(int frame) { return frame * 5000; }
  static std::int64_t instant(int frame) { return kStart_us + std::llround(frame * 1e6 / 18.0); }
  static std::int64_t arrival(int frame) { return (instant(frame) + 120000) * 1000; }
};

TEST(ExposureClock, ArrivalStandsInUntilTheFirstReport) {
  ExposureClock clock;
  const ExposureClock::Instant before = clock.stamp(Camera::pts(0), std::nullopt, Camera::arrival(0));
  EXPECT_EQ(before.exposure_ns, Camera::arrival(0));
  EXPECT_EQ(before.source, InstantSource::arrival);
  const ExposureClock::Instant after = clock.stamp(Camera::pts(1), Camera::instant(1), Camera::arrival(1));
  EXPECT_EQ(after.exposure_ns, Camera::instant(1) * 1000);
  EXPECT_EQ(after.source, InstantSource::sender_report);
  EXPECT_GT(before.deviation_ns, after.deviation_ns);
  EXPECT_GT(after.deviation_ns, 0);
}

TEST(ExposureClock, GivesTheReportedInstantsToTheMicrosecond) {
  ExposureClock clock;
  for (int i = 0; i < 2000; ++i) {
    EXPECT_EQ(clock.stamp(Camera::pts(i), Camera::instant(i), Camera::arrival(i)).exposure_ns,
              Camera::instant(i) * 1000);
  }
}

TEST(ExposureClock, CarriesOnFromRtpTimeWhereAReportIsMissing) {
  ExposureClock clock;
  clock.stamp(Camera::pts(0), Camera::instant(0), Camera::arrival(0));
  const ExposureClock::Instant instant = clock.stamp(Camera::pts(18), std::nullopt, Camera::arrival(18));
  EXPECT_EQ(instant.exposure_ns, Camera::instant(18) * 1000);
  EXPECT_EQ(instant.source, InstantSource::sender_report);
}

TEST(ExposureClock, UndoesFfmpegsJumpWhereTheRtpClockWraps) {
  ExposureClock clock;
  for (int i = 0; i < 400; ++i) {
    // The clock wraps with frame 100, and the next report comes with frame 190.
    const bool wrapped = i >= 100 && i < 190;
    const std::int64_t reported = Camera::instant(i) - (wrapped ? kWrap_us : 0);
    EXPECT_NEAR(static_cast<double>(clock.stamp(Camera::pts(i), reported, Camera::arrival(i)).exposure_ns -
                                    Camera::instant(i) * 1000),
                0.0, 1000.0)
        << "frame " << i;
  }
}

TEST(ExposureClock, AConnectionThatBeginsOnAWrapIsPutRightByTheHostsClock) {
  ExposureClock clock;
  const ExposureClock::Instant instant =
      clock.stamp(Camera::pts(0), Camera::instant(0) - kWrap_us, Camera::arrival(0));
  EXPECT_NEAR(static_cast<double>(instant.exposure_ns), static_cast<double>(Camera::instant(0) * 1000), 2e3);
}

TEST(ExposureClock, FollowsACameraWhoseClockWasSet) {
  ExposureClock clock;
  clock.stamp(Camera::pts(0), Camera::instant(0), Camera::arrival(0));
  const std::int64_t hour_us = 3'600'000'000;
  EXPECT_EQ(clock.stamp(Camera::pts(90), Camera::instant(90) + hour_us, Camera::arrival(90)).exposure_ns,
            (Camera::instant(90) + hour_us) * 1000);
}

TEST(ExposureClock, AClockThatStaysAWrapAwayIsBelieved) {
  ExposureClock clock;
  clock.stamp(Camera::pts(0), Camera::instant(0), Camera::arrival(0));
  std::int64_t last = 0;
  for (int report = 1; report < 6; ++report) {
    const int frame = report * 90;
    const std::int64_t shifted =
        Camera::instant(frame) + kWrap_us + report * 100;  // each report differs a little
    last = clock.stamp(Camera::pts(frame), shifted, Camera::arrival(frame)).exposure_ns - shifted * 1000;
  }
  EXPECT_EQ(last, 0);
}

}  // namespace
}  // namespace cartvo
