// Sender reports that are not used: each kind is named.

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/clock/stereo_timestamper.hpp"
#include "tests/support/capture/simulated_clocks.hpp"

namespace cartvo::capture {
namespace {

using test::ClockFaults;
using test::ClockSimulation;
using testing::HasSubstr;

constexpr double kYear = 365.0 * 86400.0;

/// Status after `seconds` of a camera without faults at the left and one with these faults at the right.
/// `worst`: largest offset error over the stated standard deviation after two reports.
ClockStatus statusAfter(double seconds, ClockChoice choice, const ClockFaults& right,
                        double* worst = nullptr) {
  StereoTimestamper timestamper(choice);
  ClockFaults faultless;
  faultless.report_noise = 0.0;
  ClockSimulation cameras[] = {ClockSimulation(faultless, 1), ClockSimulation(right, 2)};
  double left_error = 0.0;
  for (std::size_t side = 0;; side = cameras[0].nextExposure() <= cameras[1].nextExposure() ? 0 : 1) {
    const double exposure = cameras[side].nextExposure();
    if (exposure >= seconds) return timestamper.status();
    const ExposureTimestamp stamped = timestamper.stamp(static_cast<CameraSide>(side), cameras[side].next());
    const auto error = static_cast<double>(stamped.exposure_ns - ClockSimulation::atHost(exposure));
    if (side == 0) left_error = error;
    const double stated = std::sqrt(2.0) * static_cast<double>(stamped.exposure_stddev_ns);
    if (worst != nullptr && side == 1 && exposure > 12.0)
      *worst = std::max(*worst, std::abs(error - left_error) / stated);
  }
}

ClockFaults withClockError(const std::function<double(double)>& error) {
  ClockFaults faults;
  faults.first_exposure = 0.013;
  faults.report_noise = 0.0;
  faults.clock_error = error;
  return faults;
}

TEST(UnusedReports, NoneAreNamedOfAFaultlessCamera) {
  for (const ClockChoice choice : {ClockChoice::automatic, ClockChoice::ntp, ClockChoice::arrival}) {
    const ClockStatus status = statusAfter(120.0, choice, withClockError([](double) { return 0.0; }));
    EXPECT_EQ(status.problem + status.advice, "");
    EXPECT_EQ(status.cameras[1].left_out, 0U);
  }
}

TEST(UnusedReports, AreNotTakenAsExactAndNamedIfTheyScatter) {
  ClockFaults scattered = withClockError([](double) { return 0.0; });
  scattered.report_noise = 0.2;
  double worst = 0.0;
  const ClockStatus asserted = statusAfter(300.0, ClockChoice::ntp, scattered, &worst);
  EXPECT_LT(worst, 4.0);
  EXPECT_EQ(asserted.source, InstantSource::arrival);
  EXPECT_THAT(asserted.problem, HasSubstr("the right camera sends RTCP sender reports that scatter by 0."));
  const ClockStatus automatic = statusAfter(300.0, ClockChoice::automatic, scattered);
  EXPECT_EQ(automatic.problem, "") << "odometry goes on without them";
  EXPECT_THAT(automatic.advice, HasSubstr("the right camera sends RTCP sender reports that scatter by 0."));
}

TEST(UnusedReports, AreCountedAndNamedIfManyContradictTheOthers) {
  // Two programs set the clock in turn: each fourth report is wrong, by as much to either side.
  const auto error = [](double time) {
    const int report = static_cast<int>((time - 1.0) / 5.0);
    return report % 4 == 3 ? (report % 8 == 3 ? 5.0 : -5.0) : 0.0;
  };
  const ClockStatus status = statusAfter(300.0, ClockChoice::automatic, withClockError(error));
  EXPECT_GE(status.cameras[1].left_out, 10U);
  EXPECT_EQ(status.cameras[1].steps, 0U);
  EXPECT_THAT(status.advice, HasSubstr("the right camera's sender reports contradict each other"));
}

TEST(UnusedReports, AreNamedIfTheyDoNotFitTheHostsClock) {
  for (const double error : {kYear, 0.5, -10.0, -kYear}) {
    StereoTimestamper timestamper(ClockChoice::automatic);
    ClockSimulation left(withClockError([error](double) { return error; }), 1);
    ClockSimulation right(withClockError([error](double) { return error; }), 2);
    for (int i = 0; i < 1000; ++i) {
      timestamper.stamp(CameraSide::left, left.next());
      timestamper.stamp(CameraSide::right, right.next());
    }
    const std::string advice = timestamper.status().advice;
    EXPECT_THAT(advice, HasSubstr("the left camera's clock is "));
    EXPECT_THAT(advice, HasSubstr(error > 0.0 ? " ahead of this computer's" : " behind this computer's"));
    EXPECT_EQ(timestamper.status().source, InstantSource::sender_report) << "the cameras agree";
    timestamper.setHostClockCorrection(std::llround(1e9 * error));
    EXPECT_EQ(timestamper.status().advice, "") << "the host's clock was set";
  }
}

}  // namespace
}  // namespace cartvo::capture
