// Health messages: statistics, problems and texts, and their size.
#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/diagnostics/health_monitor.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "support/pipeline/valid_result.hpp"

namespace cartvo::daemon {
namespace {

using namespace std::string_literals;
using test::kEthernetFrame;
using test::validResult;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

HealthSnapshot snapshot(std::uint64_t frames) {
  HealthSnapshot snapshot;
  snapshot.left.state = capture::CameraState::streaming;
  snapshot.left.instant_source = capture::InstantSource::sender_report;
  snapshot.left.frames = frames;
  snapshot.right.state = capture::CameraState::streaming;
  snapshot.right.instant_source = capture::InstantSource::sender_report;
  snapshot.right.frames = frames;
  snapshot.counts.pairs = frames;
  snapshot.counts.dropped_no_partner = 4;
  snapshot.counts.skipped = 2;
  return snapshot;
}

TEST(HealthMessage, SummarisesTimeSincePreviousMessage) {
  const HealthMonitor::Clock::time_point start;
  HealthMonitor monitor(start);
  pipeline::PairResult result = validResult();
  result.times.total = 0.006;
  odometry_t message = odometryMessage(result);
  for (int i = 0; i < 100; ++i) {
    message.publication_utime = message.arrival_utime + 1000 * (i + 1);
    monitor.addPair(result, message);
  }
  monitor.addMissedPair();
  const health_t health = monitor.summarise(start + std::chrono::seconds(2), snapshot(36));
  EXPECT_FLOAT_EQ(health.latency_p50_ms, 50.0F);
  EXPECT_FLOAT_EQ(health.latency_p99_ms, 99.0F);
  EXPECT_FLOAT_EQ(health.process_ms, 6.0F);
  EXPECT_FLOAT_EQ(health.offset_ms, 3.0F);
  EXPECT_FLOAT_EQ(health.left.decode_ms, 5.0F);
  EXPECT_FLOAT_EQ(health.right.decode_ms, 3.0F);
  EXPECT_FLOAT_EQ(health.pair_rate, 18.0F);
  EXPECT_FLOAT_EQ(health.left.frame_rate, 18.0F);
  EXPECT_EQ(health.left.instant_source, +camera_health_t::SENDER_REPORT);
  EXPECT_EQ(health.estimates_valid, 100);
  EXPECT_EQ(health.estimates_invalid, 1);
  EXPECT_EQ(health.dropped_no_partner, 4);
  EXPECT_EQ(health.pairs_skipped, 2);
  EXPECT_EQ(health.uptime_us, 2'000'000);
  EXPECT_GT(health.memory_mb, 1.0F);

  const health_t next = monitor.summarise(start + std::chrono::seconds(3), snapshot(36));
  EXPECT_FLOAT_EQ(next.pair_rate, 0.0F);
  EXPECT_TRUE(std::isnan(next.latency_p50_ms));
}

TEST(HealthMessage, NamesMostImportantProblem) {
  HealthMonitor monitor{{}};
  HealthSnapshot bad = snapshot(0);
  bad.right.state = capture::CameraState::refused;
  bad.right.last_error = "the camera refused the password";
  EXPECT_EQ(monitor.summarise({}, bad).problem, "right camera: the camera refused the password");
  bad.problem = "left camera: the stream is 704x576";
  EXPECT_EQ(monitor.summarise({}, bad).problem, "left camera: the stream is 704x576");
}

/// The problem after a second of pairs of the given light that are INVALID for `reason`, or VALID without.
std::string problemOf(const std::array<pipeline::PictureLight, 2>& light, vo::OdometryReason reason,
                      const HealthSnapshot& state = snapshot(18)) {
  HealthMonitor monitor{{}};
  pipeline::PairResult result = validResult();
  result.light = light;
  if (reason != vo::OdometryReason::none) {
    result.estimate.valid = false;
    result.estimate.reasons = reason;
  }
  for (int i = 0; i < 18; ++i) {
    monitor.addPair(result, odometryMessage(result));
    result.light.reset();  // it is measured in some pairs
  }
  return monitor.summarise({}, state).problem;
}

TEST(HealthMessage, NamesDarknessAndCoveredLensesWhileTheOdometryIsInvalid) {
  const pipeline::PictureLight day{}, dusk{9.0, 0.4, 0.0, 0.1}, covered{90.0, 0.0, 0.0, 0.0};
  constexpr auto kFewMatches = vo::OdometryReason::too_few_matches;
  EXPECT_THAT(problemOf({dusk, dusk}, kFewMatches),
              StartsWith("both cameras: the picture is dark: is the lens"));
  EXPECT_THAT(problemOf({day, dusk}, kFewMatches), StartsWith("right camera: the picture is dark"));
  EXPECT_THAT(problemOf({covered, day}, vo::OdometryReason::wrong_stereo_geometry),
              StartsWith("left camera: the picture shows hardly any texture: is the lens covered"));
  EXPECT_EQ(problemOf({dusk, dusk}, vo::OdometryReason::none), "");
  EXPECT_EQ(problemOf({dusk, dusk}, vo::OdometryReason::offset_uncertain), "");
  EXPECT_EQ(problemOf({day, day}, kFewMatches), "");
  EXPECT_THAT(problemOf({day, day}, vo::OdometryReason::too_few_features),
              AllOf(StartsWith("left camera: "), HasSubstr("out of focus")));
}

TEST(HealthMessage, LeavesWhatTheOdometryDoesNotNeedUnsaidWhileItIsInvalid) {
  HealthSnapshot full = snapshot(18);
  full.recording = "not recording: the disk is full";
  EXPECT_EQ(problemOf({}, vo::OdometryReason::none, full), full.recording);
  EXPECT_EQ(problemOf({}, vo::OdometryReason::too_few_inliers, full), "");
}

TEST(HealthMessage, NamesTheRigBeforeTheRecordingAndTheCamerasAdvice) {
  HealthMonitor monitor{{}};
  pipeline::PairResult result = validResult();
  result.estimate.stereo_fault = vo::StereoFault::misaligned;
  monitor.addPair(result, odometryMessage(result));
  HealthSnapshot full = snapshot(1);
  full.recording = "not recording: the disk is full";
  full.left.advice = "packets are left out";
  EXPECT_THAT(monitor.summarise({}, full).problem, StartsWith("the pictures do not fit the rig file"));
}

TEST(HealthMessage, NamesACoveredLensBeforeAFrozenCameraButNotBeforeAnAbsentOne) {
  const pipeline::PictureLight covered{16.0, 0.0, 0.0, 0.0};
  HealthSnapshot frozen = snapshot(18);
  frozen.left.state = capture::CameraState::frozen;
  frozen.left.last_error = "switch it off and on";
  EXPECT_THAT(problemOf({covered, covered}, vo::OdometryReason::too_few_features, frozen),
              StartsWith("both cameras: the picture is dark"));
  frozen.left.state = capture::CameraState::stalled;
  EXPECT_EQ(problemOf({covered, covered}, vo::OdometryReason::too_few_features, frozen),
            "left camera: switch it off and on");
}

TEST(HealthMessage, BlamesTheRigOnlyIfThePicturesShowTexture) {
  HealthMonitor monitor{{}};
  pipeline::PairResult result = validResult();
  result.estimate.stereo_fault = vo::StereoFault::misaligned;
  result.light = {pipeline::PictureLight{}, pipeline::PictureLight{}};
  monitor.addPair(result, odometryMessage(result));
  EXPECT_THAT(monitor.summarise({}, snapshot(18)).problem,
              StartsWith("the pictures do not fit the rig file"));
  (*result.light)[1].texture = 0.0;
  monitor.addPair(result, odometryMessage(result));
  EXPECT_EQ(monitor.summarise({}, snapshot(18)).problem, "");
}

TEST(HealthMessage, SelfCheckGivesTheAdviceWhileThereIsNoFault) {
  HealthMonitor monitor{{}};
  HealthSnapshot unmounted = snapshot(1);
  EXPECT_EQ(monitor.summarise({}, unmounted).self_check, "");
  unmounted.advice = calib::kNoMountText;
  EXPECT_EQ(monitor.summarise({}, unmounted).self_check, calib::kNoMountText);
}

TEST(HealthMessage, NamesReportsThatAreNotUsedLast) {
  HealthMonitor monitor{{}};
  HealthSnapshot unused = snapshot(1);
  unused.clock.advice = "the left camera's clock is 9 s ahead";
  EXPECT_EQ(monitor.summarise({}, unused).problem, unused.clock.advice);
  unused.right.advice = "packets are left out";
  EXPECT_EQ(monitor.summarise({}, unused).problem, "right camera: packets are left out");
}

TEST(HealthMessage, HoldsClockStatus) {
  HealthMonitor monitor{{}};
  HealthSnapshot clocks = snapshot(1);
  clocks.left.instant_source = clocks.right.instant_source = capture::InstantSource::pictures;
  clocks.clock.cameras[1] = {80e6, 25e-6, 2};
  clocks.clock.offset = {0.5e6, 0.7e6};
  clocks.clock.visual = capture::OffsetEstimate{3e6, 1e6};
  clocks.clock.problem = "the cameras' clocks disagree";
  const health_t health = monitor.summarise({}, clocks);
  EXPECT_EQ(health.left.instant_source, +camera_health_t::PICTURES);
  EXPECT_TRUE(std::isnan(health.left.latency_ms));
  EXPECT_FLOAT_EQ(health.right.latency_ms, 80.0F);
  EXPECT_FLOAT_EQ(health.right.skew_ppm, 25.0F);
  EXPECT_EQ(health.right.clock_steps, 2);
  EXPECT_FLOAT_EQ(health.clock_deviation_ms, 0.7F);
  EXPECT_TRUE(std::isnan(health.clock_by_reports_ms));
  EXPECT_FLOAT_EQ(health.clock_by_pictures_ms, 3.0F);
  EXPECT_EQ(health.problem, "the cameras' clocks disagree");
}

TEST(HealthMessage, ReportsReducedFeatures) {
  HealthMonitor monitor{{}};
  HealthSnapshot slow = snapshot(0);
  slow.features = 1000;
  pipeline::PairResult result = validResult();
  for (const int features : {1000, 430, 450}) {
    result.features = features;
    monitor.addPair(result, odometryMessage(result));
  }
  const health_t health = monitor.summarise({}, slow);
  EXPECT_EQ(health.features_configured, 1000);
  EXPECT_EQ(health.features_least, 430);
  EXPECT_EQ(monitor.summarise({}, slow).features_least, 1000) << "no pairs";
}

TEST(HealthMessage, NamesAComputerThatIsTooSlowForLong) {
  HealthMonitor monitor{{}};
  HealthSnapshot slow = snapshot(0);
  slow.features = 1000;
  const auto problem_after = [&](std::chrono::seconds time, std::initializer_list<int> features) {
    pipeline::PairResult result = validResult();
    for (const int number : features) {
      result.features = number;
      monitor.addPair(result, odometryMessage(result));
    }
    return monitor.summarise(HealthMonitor::Clock::time_point(time), slow).problem;
  };
  using std::chrono::seconds;
  EXPECT_EQ(problem_after(seconds(1), {1000, 430}), "");
  EXPECT_EQ(problem_after(seconds(10), {450}), "");
  EXPECT_THAT(problem_after(seconds(11), {450}), HasSubstr("fewer than 1000 features"));
  EXPECT_EQ(problem_after(seconds(12), {990, 1000}), "");
  EXPECT_EQ(problem_after(seconds(30), {}), "");
}

TEST(HealthMessage, HoldsTheStateAfterTheLastPair) {
  // A copy of each constant: they have no address.
  const std::vector<std::pair<vo::IntegrityState, int>> codes{
      {vo::IntegrityState::tracking, +health_t::TRACKING},
      {vo::IntegrityState::standstill, +health_t::STANDSTILL},
      {vo::IntegrityState::left_frozen, +health_t::LEFT_FROZEN},
      {vo::IntegrityState::right_frozen, +health_t::RIGHT_FROZEN},
      {vo::IntegrityState::both_frozen, +health_t::BOTH_FROZEN},
      {vo::IntegrityState::lost, +health_t::LOST}};
  HealthMonitor monitor{{}};
  pipeline::PairResult result = validResult();
  for (const auto& [state, code] : codes) {
    result.estimate.state = state;
    monitor.addPair(result, odometryMessage(result));
    EXPECT_EQ(monitor.summarise({}, snapshot(1)).odometry_state, code);
  }
  result.estimate.state = vo::IntegrityState::tracking;
  monitor.addPair(result, odometryMessage(result));
  monitor.summarise({}, snapshot(1));
  EXPECT_EQ(monitor.summarise({}, snapshot(1)).odometry_state, +health_t::LOST) << "no pair";
}

TEST(HealthMessage, HoldsSelfCheckResult) {
  HealthMonitor monitor{{}};
  EXPECT_TRUE(std::isnan(monitor.summarise({}, snapshot(1)).right_late_ms)) << "not estimated yet";
  pipeline::PairResult result = validResult();
  result.estimate.rig = vo::RigCalibrationError{{0.0, 1e-4}, {0.0, 1e-4}, {0.01, 1e-4}, {3e-3, 1e-4}};
  monitor.addPair(result, odometryMessage(result));
  const health_t health = monitor.summarise({}, snapshot(1));
  EXPECT_FLOAT_EQ(health.right_late_ms, 3.0F);
  EXPECT_FLOAT_EQ(health.right_late_deviation_ms, 0.1F);
  EXPECT_NEAR(health.right_rotation_deg[2], 0.573, 0.001);
  EXPECT_FLOAT_EQ(health.right_rotation_deg[0], 0.0F);
  EXPECT_THAT(health.self_check, HasSubstr("3.0 ± 0.1 ms later"));
}

TEST(HealthMessage, NamesTheWorstBoundOfTheLastSecond) {
  HealthMonitor monitor{{}};
  pipeline::PairResult result = validResult();
  monitor.addPair(result, odometryMessage(result));
  for (const double bound : {0.7, 0.82, 0.71}) {
    result.level.velocity.x() = bound;
    result.worst = pipeline::worstBound(result.level, {});
    monitor.addPair(result, odometryMessage(result));
  }
  const health_t health = monitor.summarise({}, snapshot(1));
  EXPECT_EQ(health.bound_exceeded, "forward velocity is known to 0.82 m/s, alert limit 0.70 m/s");
  EXPECT_EQ(health.estimates_valid, 1);
  EXPECT_EQ(health.estimates_invalid, 3);
  EXPECT_EQ(monitor.summarise({}, snapshot(1)).bound_exceeded, "");
}

TEST(HealthMessage, HoldsReadouts) {
  HealthMonitor monitor({}, {0.032, 0.032});
  EXPECT_TRUE(std::isnan(monitor.summarise({}, snapshot(1)).left_readout_ms)) << "not estimated yet";
  pipeline::PairResult result = validResult();
  result.estimate.readouts = vo::ReadoutEstimates{{0.0321, 1e-4}, {-0.0384, 2e-4}};
  monitor.addPair(result, odometryMessage(result));
  const health_t health = monitor.summarise({}, snapshot(1));
  EXPECT_FLOAT_EQ(health.left_readout_ms, 32.1F);
  EXPECT_FLOAT_EQ(health.left_readout_deviation_ms, 0.1F);
  EXPECT_FLOAT_EQ(health.right_readout_ms, -38.4F);
  EXPECT_FLOAT_EQ(health.right_readout_deviation_ms, 0.2F);
  EXPECT_THAT(health.self_check, HasSubstr("-38.4 ± 0.2 ms, not 32.0 ms"));
}

std::string encoded(const health_t& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), message.getEncodedSize());
  return bytes;
}

TEST(HealthMessage, WithAnImpossibleLengthOfATextIsRefused) {
  health_t health{};
  health.version = "version";
  health.left.last_error = "left";
  health.right.last_error = "right";
  health.self_check = "self-check";
  health.problem = "problem";
  const std::string bytes = encoded(health);
  for (const std::string& text :
       {health.version, health.left.last_error, health.right.last_error, health.self_check, health.problem}) {
    for (const std::string& length : {"\x80\0\0\0"s, "\xff\xff\xff\xff"s, "\0\0\0\0"s, "\x7f\xff\xff\xff"s}) {
      std::string damaged = bytes;
      damaged.replace(bytes.find(text) - length.size(), length.size(), length);
      health_t decoded{};
      EXPECT_LT(decoded.decode(damaged.data(), 0, static_cast<int>(damaged.size())), 0) << text;
    }
  }
}

TEST(HealthMessage, HoldsFieldsOfLaterLayoutsAtItsEnd) {
  constexpr std::size_t kEmptyText = sizeof(std::int32_t) + 1;
  constexpr std::size_t kLaterFields =
      sizeof(std::int8_t) + 4 * sizeof(float) + kEmptyText;  // odometry_state, readouts, bound_exceeded
  health_t health{};
  health.problem = "unplugged";
  std::string bytes = encoded(health);
  bytes.resize(bytes.size() - kLaterFields - 1);  // and the text's terminating zero
  EXPECT_THAT(bytes, testing::EndsWith("unplugged"));
}

TEST(HealthMessage, FitsIntoOneEthernetFrameWithLongestTexts) {
  HealthMonitor monitor{{}};
  HealthSnapshot long_texts = snapshot(1);
  long_texts.left.last_error = long_texts.right.last_error = long_texts.problem =
      std::string(199, 'x') + "\u00e4\u00f6";
  pipeline::PairResult all_wrong = validResult();
  all_wrong.worst = {pipeline::BoundedQuantity::motion, 1, 123456.0, 0.15};
  all_wrong.estimate.rig = vo::RigCalibrationError{{1.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}};
  monitor.addPair(all_wrong, odometryMessage(all_wrong));
  const health_t health = monitor.summarise({}, long_texts);
  EXPECT_EQ(health.problem, std::string(199, 'x')) << "cut before the two-byte character";
  EXPECT_GE(health.self_check.size(), 199U);
  EXPECT_LE(health.getEncodedSize(), kEthernetFrame);
}

}  // namespace
}  // namespace cartvo::daemon
