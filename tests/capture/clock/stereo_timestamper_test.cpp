// Time stamps of two simulated cameras, compared with their true exposures.

#include "capture/clock/stereo_timestamper.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/capture/simulated_clocks.hpp"

namespace cartvo::capture {
namespace {

using test::ClockFaults;
using test::ClockSimulation;
using testing::HasSubstr;

constexpr std::size_t kRight = 1;

/// Free-running cameras of one model; the latencies of their fastest packets differ by 0.3 ms.
ClockFaults leftFaults() {
  ClockFaults faults;
  faults.skew = 50e-6;
  faults.latency = 0.0800;
  return faults;
}
ClockFaults rightFaults() {
  ClockFaults faults = leftFaults();
  faults.first_exposure = 0.013;
  faults.skew = -30e-6;
  faults.latency = 0.0803;
  return faults;
}

/// Error of a pair's time offset.
struct Error {
  double time = 0.0;      ///< s
  double offset = 0.0;    ///< error of right minus left, s
  double stddev = 0.0;    ///< reported standard deviation of the offset, s
  double absolute = 0.0;  ///< error of the right exposure on the host's clock, s
};

/// Two simulated cameras, timestamped in the order of their exposures.
class SimulatedPair {
 public:
  SimulatedPair(StereoTimestamper& timestamper, const ClockFaults& left, const ClockFaults& right)
      : timestamper_(timestamper), cameras_{ClockSimulation(left, 1), ClockSimulation(right, 2)} {}

  std::vector<Error> until(double end) {
    std::vector<Error> errors;
    for (;;) {
      const std::size_t side = cameras_[0].nextExposure() <= cameras_[1].nextExposure() ? 0 : 1;
      const double exposure = cameras_[side].nextExposure();
      if (exposure >= end) return errors;
      const ExposureTimestamp instant =
          timestamper_.stamp(static_cast<CameraSide>(side), cameras_[side].next());
      const double error =
          static_cast<double>(instant.exposure_ns - ClockSimulation::atHost(exposure)) * 1e-9;
      if (last_ns_[side]) {
        steps_.push_back(static_cast<double>(instant.exposure_ns - *last_ns_[side]) * 1e-9);
      }
      last_ns_[side] = instant.exposure_ns;
      if (side == kRight) {
        errors.push_back({exposure, error - left_error_,
                          std::sqrt(2.0) * static_cast<double>(instant.exposure_stddev_ns) * 1e-9, error});
      } else {
        left_error_ = error;
      }
    }
  }

  /// Differences of consecutive exposures of the same camera, as returned, s.
  const std::vector<double>& steps() const { return steps_; }

 private:
  StereoTimestamper& timestamper_;
  ClockSimulation cameras_[2];
  std::optional<std::int64_t> last_ns_[2];
  double left_error_ = 0.0;
  std::vector<double> steps_;
};

struct ErrorStatistics {
  double rms = 0.0;
  double worst = 0.0;
  double covered = 0.0;  ///< share of errors within two reported standard deviations
};

ErrorStatistics statisticsAfter(double start, const std::vector<Error>& errors) {
  ErrorStatistics statistics;
  double count = 0.0;
  for (const Error& error : errors) {
    if (error.time < start) continue;
    count += 1.0;
    statistics.rms += error.offset * error.offset;
    statistics.worst = std::max(statistics.worst, std::abs(error.offset));
    statistics.covered += std::abs(error.offset) <= 2.0 * error.stddev ? 1.0 : 0.0;
  }
  statistics.rms = std::sqrt(statistics.rms / count);
  statistics.covered /= count;
  return statistics;
}

void print(const char* what, const ErrorStatistics& statistics) {
  std::printf("%s: RMS %.3f ms, worst %.3f ms, %.1f %% within two standard deviations\n", what,
              1e3 * statistics.rms, 1e3 * statistics.worst, 100.0 * statistics.covered);
}

TEST(StereoTimestamper, StaysAccurateOverFifteenHoursOfNoisyReportsWithWrapsAndStep) {
  ClockFaults left = leftFaults();
  ClockFaults right = rightFaults();
  left.first_rtp = 4'000'000'000;   // wraps after 55 minutes
  right.first_rtp = 1'000'000'000;  // and after 10 hours
  right.clock_error = [](double time) { return time < 7.0 * 3600.0 ? 0.0 : 0.3; };
  StereoTimestamper timestamper(ClockChoice::automatic);
  SimulatedPair pair(timestamper, left, right);
  const std::vector<Error> errors = pair.until(15.0 * 3600.0);

  const ErrorStatistics soon = statisticsAfter(30.0, errors);
  const ErrorStatistics later = statisticsAfter(300.0, errors);
  print("after 30 s", soon);
  print("after 5 min", later);
  EXPECT_LE(soon.worst, 2e-3);
  EXPECT_LE(later.rms, 0.5e-3);
  EXPECT_GE(later.covered, 0.95);
  EXPECT_GE(soon.covered, 0.95);
  ASSERT_FALSE(pair.steps().empty());
  EXPECT_GE(*std::min_element(pair.steps().begin(), pair.steps().end()), 0.0);
  EXPECT_EQ(timestamper.status().cameras[1].steps, 1U);
  EXPECT_THAT(timestamper.status().problem, HasSubstr("the cameras' clocks disagree by "));
}

TEST(StereoTimestamper, NamesALateCameraBesideDisagreeingClocks) {
  ClockFaults right = rightFaults();
  right.clock_error = [](double) { return -0.3; };
  StereoTimestamper timestamper(ClockChoice::automatic);
  SimulatedPair(timestamper, leftFaults(), right).until(60.0);
  EXPECT_THAT(timestamper.status().problem, HasSubstr("or the right camera's pictures come late"));
  EXPECT_THAT(timestamper.status().problem, HasSubstr("if they are, connect without a re-streamer"));
}

TEST(StereoTimestamper, SlewsWhenReportsBegin) {
  ClockFaults left = leftFaults();
  left.report_noise = 0.0;
  ClockFaults right = rightFaults();
  right.report_noise = 0.0;
  StereoTimestamper timestamper(ClockChoice::automatic);
  SimulatedPair pair(timestamper, left, right);
  pair.until(0.9);  // no report yet
  EXPECT_EQ(timestamper.status().source, InstantSource::arrival);
  pair.until(7.0);
  const std::size_t begun = pair.steps().size();
  const std::vector<Error> errors = pair.until(120.0);
  EXPECT_EQ(timestamper.status().source, InstantSource::sender_report);
  for (std::size_t i = begun; i < pair.steps().size(); ++i)
    ASSERT_NEAR(pair.steps()[i], 0.04, 0.006 * 0.04) << "slewed by at most half a percent";
  ASSERT_FALSE(errors.empty());
  // The error equals the latency at first and vanishes in the end.
  EXPECT_NEAR(errors.front().absolute, 0.08, 0.02);
  EXPECT_NEAR(errors.back().absolute, 0.0, 0.5e-3);
  for (const Error& error : errors)
    ASSERT_NEAR(error.offset, 0.0, 1.5e-3) << "both cameras are slewed together, " << error.time;
}

TEST(StereoTimestamper, CorrectsBothPicturesOfAPairAlikeWhicheverComesFirst) {
  for (const std::size_t first : {0U, 1U}) {
    ClockFaults faults = leftFaults();
    faults.jitter = faults.burst = faults.report_noise = 0.0;
    ClockFaults without_reports = faults;
    without_reports.report_interval = 0.0;
    ClockSimulation cameras[] = {ClockSimulation(faults, 1), ClockSimulation(without_reports, 2)};
    StereoTimestamper timestamper(ClockChoice::ntp);
    std::int64_t begin_ns = 0;
    for (int i = 0; i < 150; ++i) {
      std::int64_t exposures[2] = {};
      for (const std::size_t side : {first, 1 - first})
        exposures[side] = timestamper.stamp(static_cast<CameraSide>(side), cameras[side].next()).exposure_ns;
      ASSERT_NEAR(static_cast<double>(exposures[1] - exposures[0]), 0.0, 0.1e6) << i;
      if (i == 0) begin_ns = exposures[0];
      if (i == 149) {
        EXPECT_NEAR(static_cast<double>(exposures[0] - begin_ns), 149 * 40e6 - 80e6, 1e6);
      }
    }
  }
}

TEST(StereoTimestamper, UsesExactReportsWithChoiceNtp) {
  ClockFaults left = leftFaults();
  left.report_noise = 0.0;
  ClockFaults right = rightFaults();
  right.report_noise = 0.0;
  right.latency = left.latency + 0.012;  // not the same model
  StereoTimestamper timestamper(ClockChoice::ntp);
  SimulatedPair pair(timestamper, left, right);
  const ErrorStatistics statistics = statisticsAfter(60.0, pair.until(600.0));
  EXPECT_LE(statistics.worst, 0.05e-3);
  EXPECT_GE(statistics.covered, 0.95);
  EXPECT_NEAR(*timestamper.status().cameras[1].latency_ns - *timestamper.status().cameras[0].latency_ns, 12e6,
              0.3e6);
}

TEST(StereoTimestamper, EstimatesOffsetFromFastestPacketsWithoutReports) {
  for (const double jitter : {1e-3, 10e-3}) {
    ClockFaults left = leftFaults();
    left.report_interval = 0.0;
    left.jitter = jitter;
    ClockFaults right = rightFaults();
    right.report_interval = 0.0;
    right.jitter = jitter;
    StereoTimestamper timestamper(ClockChoice::automatic);
    SimulatedPair pair(timestamper, left, right);
    const std::vector<Error> errors = pair.until(1800.0);
    EXPECT_LE(statisticsAfter(30.0, errors).worst, 2e-3) << jitter;
    EXPECT_LE(statisticsAfter(300.0, errors).rms, 0.5e-3) << jitter;
    EXPECT_GE(statisticsAfter(0.0, errors).covered, 0.95) << jitter;
    EXPECT_EQ(timestamper.status().source, InstantSource::arrival);
  }
}

TEST(StereoTimestamper, ToleratesClockStepsAtEachNtpPoll) {
  ClockFaults left = leftFaults();
  left.report_noise = 1e-3;
  ClockFaults right = rightFaults();
  right.report_noise = 1e-3;
  // The clock drifts by 20 ppm between two polls, ten minutes apart.
  right.clock_error = [](double time) { return 20e-6 * std::fmod(time, 600.0); };
  StereoTimestamper timestamper(ClockChoice::automatic);
  SimulatedPair pair(timestamper, left, right);
  const std::vector<Error> errors = pair.until(2.0 * 3600.0);
  const ErrorStatistics statistics = statisticsAfter(300.0, errors);
  print("clock stepped by 12 ms each 10 min", statistics);
  EXPECT_LE(statistics.worst, 2.5e-3);
  EXPECT_GE(statistics.covered, 0.95);
}

TEST(StereoTimestamper, IgnoresReportWrongByAnHour) {
  ClockFaults right = rightFaults();
  right.clock_error = [](double time) { return time > 300.0 && time < 304.9 ? 3600.0 : 0.0; };
  StereoTimestamper timestamper(ClockChoice::automatic);
  SimulatedPair pair(timestamper, leftFaults(), right);
  EXPECT_LE(statisticsAfter(30.0, pair.until(600.0)).worst, 2e-3);
  EXPECT_EQ(timestamper.status().cameras[1].steps, 0U);
  EXPECT_EQ(timestamper.status().problem, "");
}

TEST(StereoTimestamper, ReportsCameraClockWrongByAnHourAndUsesArrival) {
  for (const ClockChoice choice : {ClockChoice::automatic, ClockChoice::ntp}) {
    ClockFaults right = rightFaults();
    right.clock_error = [](double) { return 3600.0; };
    StereoTimestamper timestamper(choice);
    SimulatedPair pair(timestamper, leftFaults(), right);
    EXPECT_LE(statisticsAfter(30.0, pair.until(600.0)).worst, 2e-3);
    EXPECT_THAT(timestamper.status().problem, HasSubstr("the cameras' clocks disagree by 3"));
    EXPECT_THAT(timestamper.status().problem, HasSubstr("exposures are computed from arrival times"));
    EXPECT_EQ(timestamper.status().source, InstantSource::arrival);
  }
}

TEST(StereoTimestamper, UsesReportsThatAgreeIfHostClockIsWrong) {
  ClockFaults left = leftFaults();
  left.report_noise = 0.0;
  left.clock_error = [](double) { return 3.0e7; };
  ClockFaults right = rightFaults();
  right.report_noise = 0.0;
  right.clock_error = left.clock_error;
  StereoTimestamper timestamper(ClockChoice::automatic);
  SimulatedPair pair(timestamper, left, right);
  const std::vector<Error> errors = pair.until(120.0);
  EXPECT_EQ(timestamper.status().source, InstantSource::sender_report);
  ASSERT_FALSE(errors.empty());
  EXPECT_NEAR(errors.back().offset, 0.0, 0.5e-3);
  EXPECT_NEAR(errors.back().absolute, 0.08, 1e-3) << "exposures stay on the host's clock";
}

TEST(StereoTimestamper, UsesVisualOffsetIfLatenciesDiffer) {
  ClockFaults left = leftFaults();
  ClockFaults right = rightFaults();
  right.latency = left.latency + 0.010;
  for (const ClockChoice choice : {ClockChoice::automatic, ClockChoice::visual}) {
    StereoTimestamper timestamper(choice);
    SimulatedPair pair(timestamper, left, right);
    pair.until(60.0);
    timestamper.setVisual(OffsetEstimate{-10e6, 0.5e6});
    EXPECT_LE(statisticsAfter(80.0, pair.until(300.0)).worst, 2e-3);
    EXPECT_EQ(timestamper.status().source, InstantSource::pictures);
  }
}

TEST(StereoTimestamper, FollowsHostClockThatIsSet) {
  StereoTimestamper timestamper(ClockChoice::arrival);
  ClockFaults one_crystal = rightFaults();
  one_crystal.skew = leftFaults().skew;
  ClockSimulation left(leftFaults(), 1);
  ClockSimulation right(one_crystal, 2);
  const auto stamp = [&](std::int64_t set_ns) {
    RtpTimestamps from_left = left.next();
    RtpTimestamps from_right = right.next();
    from_left.arrival_ns += set_ns;
    from_right.arrival_ns += set_ns;
    const std::int64_t left_ns = timestamper.stamp(CameraSide::left, from_left).exposure_ns;
    return std::pair(left_ns - set_ns,
                     timestamper.stamp(CameraSide::right, from_right).exposure_ns - left_ns);
  };
  std::pair<std::int64_t, std::int64_t> before;
  for (int i = 0; i < 1000; ++i)
    before = stamp(0);
  for (const std::int64_t set_ns : {-3'600'000'000'000, 3'600'000'000'000}) {
    std::pair<std::int64_t, std::int64_t> after;
    for (int i = 0; i < 1000; ++i)
      after = stamp(set_ns);
    EXPECT_NEAR(static_cast<double>(after.second), 0.013e9, 3e6) << set_ns;
    EXPECT_NEAR(static_cast<double>(after.first - before.first), 40e9, 0.1e9) << set_ns;
    before = after;
  }
}

TEST(StereoTimestamper, ExposuresIncreaseWithArrivalsDespiteWrongCameraTimes) {
  // RTP time at twice the rate or in jumps, and wrong reports.
  for (const std::uint32_t ticks : {7200U, 5'000'000U, 0x7fffffffU}) {
    StereoTimestamper timestamper(ClockChoice::automatic);
    RtpTimestamps packet;
    packet.arrival_ns = ClockSimulation::kEpoch_ns;
    std::int64_t last = 0;
    for (int i = 0; i < 1000; ++i) {
      packet.pts = static_cast<std::uint32_t>(packet.pts) + (i % 50 == 49 ? 3600U : ticks);
      packet.arrival_ns += 40'000'000;
      if (i % 25 == 0) packet.reference_us = packet.arrival_ns / 1000 - (i % 2) * 2'000'000 - 80'000;
      if (i % 300 == 299) timestamper.connect(CameraSide::left);
      const ExposureTimestamp instant = timestamper.stamp(CameraSide::left, packet);
      const bool is_back = ticks == 0x7fffffffU;  // each second picture is two ticks before the last but one
      if (!is_back) {
        ASSERT_GT(instant.exposure_ns, last) << ticks << " " << i;
      }
      last = instant.exposure_ns;
    }
  }
}

TEST(StereoTimestamper, UsesOnlyLower32BitsOfRtpTime) {
  StereoTimestamper timestamper(ClockChoice::arrival), of_large(ClockChoice::arrival);
  for (std::int64_t i = 0; i < 100; ++i) {
    const std::int64_t pts = 3600 * i, arrival_ns = ClockSimulation::kEpoch_ns + 40'000'000 * i;
    const std::int64_t large = std::numeric_limits<std::int64_t>::min() + (i % 3 << 40) + pts;
    ASSERT_EQ(of_large.stamp(CameraSide::left, {large, std::nullopt, arrival_ns}).exposure_ns,
              timestamper.stamp(CameraSide::left, {pts, std::nullopt, arrival_ns}).exposure_ns);
  }
}

TEST(StereoTimestamper, NewConnectionContinuesAfterLastExposure) {
  StereoTimestamper timestamper(ClockChoice::automatic);
  std::int64_t last = 0;
  for (unsigned connection = 0; connection < 5; ++connection) {
    ClockFaults faults = leftFaults();
    faults.first_exposure = 10.0 * connection;
    faults.first_rtp = 77'777'777 * connection;
    ClockSimulation camera(faults, connection);
    timestamper.connect(CameraSide::left);
    for (int i = 0; i < 240; ++i) {
      const ExposureTimestamp instant = timestamper.stamp(CameraSide::left, camera.next());
      ASSERT_GT(instant.exposure_ns, last);
      last = instant.exposure_ns;
    }
  }
}

}  // namespace
}  // namespace cartvo::capture
