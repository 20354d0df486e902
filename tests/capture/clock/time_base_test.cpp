// Faults of a stream's time base: backlogs, nominal rates, jumps and stray time stamps.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/clock/arrival_clock_model.hpp"
#include "capture/clock/stereo_timestamper.hpp"

namespace cartvo::capture {
namespace {

using testing::HasSubstr;

constexpr double kFrameRate = 18.0;
constexpr std::int64_t kEpoch_ns = 1'700'000'000'000'000'000;
constexpr double kValidStddev = 10e6 / 1.42;  ///< ns of one camera: the default limit of the odometry

/// Picture i of a camera that exposes at i / kFrameRate, s.
struct Picture {
  std::int64_t arrival_ns = 0;
  std::int64_t pts = 0;
};

std::int64_t nanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

/// One camera's picture stamped, with the errors that count.
struct Stamped {
  double time = 0.0;          ///< true exposure, s
  double step_error = 0.0;    ///< relative error of the time step since the last picture, without slew
  double age_error = 0.0;     ///< exposure later than the arrival by so much, s; negative: earlier
  bool may_be_valid = false;  ///< the standard deviation permits valid motions
  bool is_usable = true;
};

/// Both cameras' pictures, the left one's by `left`, stamped as they arrive. The right camera has no faults.
std::vector<Stamped> stampLeft(StereoTimestamper& timestamper, double seconds,
                               const std::function<Picture(int, double)>& left) {
  struct Arrival {
    CameraSide side;
    Picture picture;
    double time;
  };
  std::vector<Arrival> arrivals;
  for (int i = 0; i < static_cast<int>(seconds * kFrameRate); ++i) {
    const double time = i / kFrameRate;
    arrivals.push_back({CameraSide::left, left(i, time), time});
    arrivals.push_back(
        {CameraSide::right,
         {kEpoch_ns + nanoseconds(time + 0.013 + 0.08), std::llround(90000.0 * (time + 0.013))},
         time});
  }
  std::stable_sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) {
    return a.picture.arrival_ns < b.picture.arrival_ns;
  });
  std::vector<Stamped> stamped;
  std::optional<std::int64_t> last;
  for (const Arrival& arrival : arrivals) {
    const ExposureTimestamp t =
        timestamper.stamp(arrival.side, {arrival.picture.pts, std::nullopt, arrival.picture.arrival_ns});
    if (arrival.side == CameraSide::right) continue;
    const std::int64_t own = t.exposure_ns - t.slew_ns;
    const double step = last ? static_cast<double>(own - *last) * 1e-9 * kFrameRate - 1.0 : 0.0;
    last = own;
    stamped.push_back({arrival.time, step,
                       static_cast<double>(t.exposure_ns - arrival.picture.arrival_ns) * 1e-9,
                       static_cast<double>(t.exposure_stddev_ns) < kValidStddev, t.is_usable});
  }
  return stamped;
}

std::size_t countValid(const std::vector<Stamped>& stamped, double from, double to) {
  return static_cast<std::size_t>(std::count_if(stamped.begin(), stamped.end(), [&](const Stamped& s) {
    return s.may_be_valid && s.is_usable && s.time >= from && s.time < to;
  }));
}

Picture regular(double time) {
  return {kEpoch_ns + nanoseconds(time + 0.08), std::llround(90000.0 * time)};
}

TEST(TimeBase, IsSettledHalfASecondAfterAConnection) {
  StereoTimestamper timestamper(ClockChoice::automatic);
  const auto stamped = stampLeft(timestamper, 3.0, [](int, double time) { return regular(time); });
  EXPECT_EQ(countValid(stamped, 0.0, 0.3), 0U);
  EXPECT_EQ(countValid(stamped, 0.6, 3.0), stamped.size() - 11);
  EXPECT_EQ(timestamper.status().problem, "");
}

TEST(TimeBase, BacklogAtTheBeginningGivesNoValidInstantsAndNoWrongTimeSteps) {
  // The camera (or a relay) sends a backlog of a second: at once, or at two or 1.25 times the pace.
  for (const double speed : {1000.0, 2.0, 1.25}) {
    StereoTimestamper timestamper(ClockChoice::automatic);
    const auto stamped = stampLeft(timestamper, 12.0, [&](int, double time) {
      Picture picture = regular(time);
      picture.arrival_ns = std::max(picture.arrival_ns, kEpoch_ns + nanoseconds(1.08 + time / speed));
      return picture;
    });
    const double drained = 1.0 / (1.0 - 1.0 / speed);
    EXPECT_EQ(countValid(stamped, 0.0, drained - 0.1), 0U) << speed;
    EXPECT_GT(countValid(stamped, drained + 2.0, 12.0), 0.9 * kFrameRate * (10.0 - drained)) << speed;
    for (const Stamped& s : stamped) {
      EXPECT_NEAR(s.step_error, 0.0, 1e-3) << speed << " " << s.time;
      if (s.may_be_valid) {
        EXPECT_LT(s.age_error, 1e-3) << "exposed after its arrival: " << speed << " " << s.time;
      }
    }
  }
}

TEST(TimeBase, NominalRateIsNamedAndNeverValid) {
  for (const double factor : {25.0 / 21.0, 15.0 / 18.0}) {
    StereoTimestamper timestamper(ClockChoice::automatic);
    const auto stamped = stampLeft(timestamper, 12.0, [&](int, double time) {
      Picture picture = regular(time);
      picture.pts = std::llround(90000.0 * time * factor);
      return picture;
    });
    EXPECT_EQ(countValid(stamped, 0.0, 12.0), 0U) << factor;
    EXPECT_THAT(timestamper.status().problem, HasSubstr("the left camera's RTP time runs")) << factor;
    EXPECT_THAT(timestamper.status().problem, HasSubstr(factor > 1.0 ? "too fast" : "too slow")) << factor;
  }
}

TEST(TimeBase, RtpTimeInAnotherUnitIsNamed) {
  struct Unit {
    double ticks = 0.0;  ///< a second
    const char* problem = "";
  };
  const Unit units[] = {
      {kFrameRate, "it counts 18 a second, not 90000"},
      {1e3, "it counts 1000 a second, not 90000"},
      {8e3, "it counts 8000 a second, not 90000"},
      {1e6, "it counts 1000000 a second, not 90000"},
      {1e9, "does not go on from picture to picture"},
      {2.0 * 90e3, "runs 100.0 % too fast, so that no motion can be measured: its frame rate"}};
  for (const Unit& unit : units) {
    StereoTimestamper timestamper(ClockChoice::automatic);
    const auto stamped = stampLeft(timestamper, 12.0, [&](int, double time) {
      Picture picture = regular(time);
      picture.pts = std::llround(unit.ticks * time);
      return picture;
    });
    EXPECT_EQ(countValid(stamped, 0.0, 12.0), 0U) << unit.ticks;
    EXPECT_THAT(timestamper.status().problem, HasSubstr("the left camera's RTP time ")) << unit.ticks;
    EXPECT_THAT(timestamper.status().problem, HasSubstr(unit.problem));
  }
}

TEST(TimeBase, SkewBeyondACrystalIsFollowedOrNamed) {
  // 200 ppm to 2 %: from beyond the limit of a crystal to beyond that of the pace.
  for (const double skew : {2e-4, 5e-4, 1e-3, 3e-3, 5e-3, 7e-3, 2e-2}) {
    for (const double sign : {-1.0, 1.0}) {
      StereoTimestamper timestamper(ClockChoice::automatic);
      const auto stamped = stampLeft(timestamper, 240.0, [&](int, double time) {
        Picture picture = regular(time);
        picture.pts = std::llround(90000.0 * time * (1.0 + sign * skew));
        return picture;
      });
      const std::size_t valid = countValid(stamped, 180.0, 240.0);
      const bool is_followed = valid > 1000;
      EXPECT_NE(is_followed, timestamper.status().problem.find("RTP time runs") != std::string::npos)
          << sign * skew << ": " << valid << " valid, " << timestamper.status().problem;
      EXPECT_TRUE(is_followed || skew > 4e-3) << sign * skew;
      if (is_followed) {
        EXPECT_NEAR(timestamper.status().cameras[0].skew, -sign * skew, 0.02 * skew + 1e-5);
        EXPECT_NEAR(stamped.back().age_error, 0.0, 5e-3) << sign * skew;
      }
    }
  }
}

TEST(TimeBase, UnevenRtpTimeIsNamedOnlyIfExposuresAreEven) {
  const auto problemOf = [](const std::function<Picture(int, double)>& left) {
    StereoTimestamper timestamper(ClockChoice::automatic);
    stampLeft(timestamper, 8.0, left);
    return timestamper.status().problem;
  };
  std::mt19937 random(1);
  std::exponential_distribution<double> delay(1.0 / 0.002);
  const auto with_delay = [&](Picture picture) {
    picture.arrival_ns += nanoseconds(delay(random));
    return picture;
  };
  EXPECT_THAT(problemOf([&](int, double time) {
                Picture picture = with_delay(regular(time));
                picture.pts = 900 * std::llround(100.0 * time);  // rounded to 10 ms
                return picture;
              }),
              HasSubstr("the left camera's RTP time is uneven by"));
  EXPECT_THAT(problemOf([&](int i, double time) {
                Picture picture = with_delay(regular(time));
                if (i % 18 == 0) picture.pts += 1800;  // 20 ms late in key pictures
                return picture;
              }),
              HasSubstr("the left camera's RTP time is uneven by"));
  EXPECT_EQ(problemOf([&](int i, double time) {
              return with_delay(regular(time + (i % 3 == 0 ? 0.01 : 0.0)));  // exposed unevenly
            }),
            "");
  EXPECT_EQ(problemOf([&](int, double time) { return with_delay(with_delay(regular(time))); }), "");
}

TEST(TimeBase, ProcessThatStoodStillTakesThePicturesThatWaited) {
  // SIGSTOP or a suspended host: all that was sent meanwhile is read at once.
  for (const double pause : {3.0, 8.0, 30.0}) {
    StereoTimestamper timestamper(ClockChoice::automatic);
    const auto stamped = stampLeft(timestamper, 60.0, [&](int, double time) {
      Picture picture = regular(time);
      if (time >= 20.0 && time < 20.0 + pause) picture.arrival_ns = kEpoch_ns + nanoseconds(20.08 + pause);
      return picture;
    });
    EXPECT_EQ(timestamper.status().problem, "") << pause;
    EXPECT_GT(countValid(stamped, 21.0 + pause, 60.0), static_cast<std::size_t>((38.0 - pause) * kFrameRate))
        << pause;
    for (const Stamped& s : stamped) {
      if (s.time > 20.0 + pause) {
        EXPECT_NEAR(s.age_error, 0.0, 2e-3) << pause << " " << s.time;
      }
    }
  }
}

TEST(TimeBase, OffsetThatStaysUncertainIsExplained) {
  // Pictures wait for up to a second, each anew: neither a pace nor a jump.
  StereoTimestamper timestamper(ClockChoice::automatic);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> delay(0.0, 1.0);
  double last = 0.0;
  const auto stamped = stampLeft(timestamper, 20.0, [&](int, double time) {
    Picture picture = regular(time);
    last = std::max(last, time + delay(random));
    picture.arrival_ns = kEpoch_ns + nanoseconds(last + 0.08);
    return picture;
  });
  ASSERT_LT(countValid(stamped, 10.0, 20.0), 90U);
  EXPECT_THAT(timestamper.status().problem, HasSubstr("the time offset between the cameras is"));
}

TEST(TimeBase, SlowAndUnsteadyArrivalsAreNotTakenForAWrongPace) {
  // A slow computer or a poor radio link: mean delays of 30 ms, at 3 pictures a second and more.
  for (const double rate : {3.0, 18.0}) {
    std::mt19937 random(1);
    std::exponential_distribution<double> delay(1.0 / 0.03);
    ArrivalPace pace;
    std::size_t settled = 0;
    std::size_t wrong = 0;
    const int pictures = static_cast<int>(600.0 * rate);
    for (int i = 0; i < pictures; ++i) {
      const double time = i / rate;
      pace.add(nanoseconds(time), kEpoch_ns + nanoseconds(time + 0.08 + delay(random)));
      settled += pace.isSettled() ? 1U : 0U;
      wrong += pace.deviation() ? 1U : 0U;
    }
    EXPECT_EQ(wrong, 0U) << rate;
    EXPECT_GT(settled, static_cast<std::size_t>(0.98 * pictures)) << rate;
  }
}

TEST(TimeBase, ClockBeginsAnewAfterAJumpOfRtpTime) {
  for (const double jump : {4.0 * 3600.0, -1200.0, -3.0}) {
    StereoTimestamper timestamper(ClockChoice::automatic);
    const auto stamped = stampLeft(timestamper, 10.0, [&](int, double time) {
      Picture picture = regular(time);
      if (time >= 4.0) picture.pts += std::llround(90000.0 * jump);
      return picture;
    });
    EXPECT_GT(countValid(stamped, 5.0, 10.0), 85U) << jump;
    EXPECT_EQ(countValid(stamped, 4.0, 4.3), 0U) << jump;
    EXPECT_THAT(timestamper.status().problem,
                HasSubstr("RTP time jumped by " + std::to_string(jump).substr(0, 4)))
        << jump;
  }
}

TEST(TimeBase, StrayTimeStampsCostOnePictureEach) {
  StereoTimestamper timestamper(ClockChoice::automatic);
  int strays = 0;
  const auto stamped = stampLeft(timestamper, 20.0, [&](int i, double time) {
    Picture picture = regular(time);
    if (i % 36 == 35) picture.pts += (++strays % 2 == 0 ? 5 : -5) * 3600 * 90000LL;
    return picture;
  });
  EXPECT_EQ(std::count_if(stamped.begin(), stamped.end(), [](const Stamped& s) { return !s.is_usable; }),
            strays);
  EXPECT_GT(countValid(stamped, 1.0, 20.0), static_cast<std::size_t>(19.0 * kFrameRate) - 12U);
}

TEST(TimeBase, LatePicturesOfABusyNetworkChangeNothing) {
  StereoTimestamper timestamper(ClockChoice::automatic);
  const auto stamped = stampLeft(timestamper, 10.0, [&](int, double time) {
    Picture picture = regular(time);  // nothing arrives for 0.8 s, then all of it
    if (time >= 5.0 && time < 5.8) picture.arrival_ns = kEpoch_ns + nanoseconds(5.88);
    return picture;
  });
  EXPECT_EQ(countValid(stamped, 1.0, 10.0), 162U);
  for (const Stamped& s : stamped)
    EXPECT_NEAR(s.step_error, 0.0, 1e-3) << s.time;
}

TEST(TimeBase, NewConnectionIsSettledBeforeItIsValid) {
  StereoTimestamper timestamper(ClockChoice::automatic);
  stampLeft(timestamper, 5.0, [](int, double time) { return regular(time); });
  timestamper.connect(CameraSide::left);
  // Its first pictures are late by 0.2 s.
  std::size_t valid = 0;
  for (int i = 0; i < 90; ++i) {
    const double time = 7.0 + i / kFrameRate;
    const double late = i < 5 ? 0.2 : 0.0;
    const ExposureTimestamp t = timestamper.stamp(
        CameraSide::left, {i * 5000, std::nullopt, kEpoch_ns + nanoseconds(time + 0.08 + late)});
    if (static_cast<double>(t.exposure_stddev_ns) >= kValidStddev) continue;
    ++valid;
    EXPECT_GT(i, 8);
    EXPECT_NEAR(static_cast<double>(t.exposure_ns - kEpoch_ns) * 1e-9, time + 0.08, 1e-3) << i;
  }
  EXPECT_GT(valid, 70U);
}

}  // namespace
}  // namespace cartvo::capture
