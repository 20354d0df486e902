// Odometry and health messages: fields of valid and invalid ones, and their size.

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <cartvo/health_t.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "common/host_clock.hpp"
#include "daemon/diagnostics/health_monitor.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "daemon/publish/odometry_reasons.hpp"
#include "support/places.hpp"

namespace cartvo::daemon {
namespace {

using namespace std::string_literals;

constexpr int kEthernetFrame = 1400;  // bytes that LCM sends unfragmented, without its header

constexpr std::int32_t bits(std::int32_t first, std::int32_t second) {
  return first | second;
}

PairResult validResult() {
  PairResult result;
  result.left = {1'000'000'500'000, 1'000'020'000'000, 1'000'025'000'000, 7};
  result.right = {1'000'003'500'000, 1'000'021'000'000, 1'000'024'000'000, 9};
  result.estimate.valid = true;
  result.estimate.time_step = 0.05;
  result.estimate.reset_counter = 3;
  result.estimate.counts = {900, 800, 700, 600};
  result.motion.T_world_body.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  result.motion.T_world_body.rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  result.motion.velocity = Eigen::Vector3d(4.0, 0.1, -0.2);
  result.motion.angular_velocity = Eigen::Vector3d(0.01, 0.02, 0.3);
  for (int i = 0; i < 36; ++i)
    result.motion.pose_covariance(i / 6, i % 6) = i;
  result.motion.twist_covariance = vo::Matrix6d::Identity();
  return result;
}

TEST(OdometryMessage, HoldsEstimateInMicrosecondsAndBodyAxes) {
  const odometry_t message = odometryMessage(validResult());
  EXPECT_EQ(message.utime, 1'000'000'500);
  EXPECT_EQ(message.arrival_utime, 1'000'021'000) << "the later of the two last packets";
  EXPECT_EQ(message.offset_us, 3'000);
  EXPECT_EQ(message.status, +odometry_t::VALID);
  EXPECT_EQ(message.reasons, 0);
  EXPECT_EQ(message.reset_counter, 3);
  EXPECT_EQ(message.features, 900);
  EXPECT_EQ(message.tracked, 800);
  EXPECT_EQ(message.inliers, 600);
  EXPECT_DOUBLE_EQ(message.position_world_body[2], 3.0);
  EXPECT_NEAR(message.orientation_world_body[0], std::cos(0.25), 1e-12) << "w comes first";
  EXPECT_NEAR(message.orientation_world_body[3], std::sin(0.25), 1e-12);
  EXPECT_DOUBLE_EQ(message.velocity_body[0], 4.0);
  EXPECT_DOUBLE_EQ(message.angular_velocity_body[2], 0.3);
  EXPECT_DOUBLE_EQ(message.pose_covariance_body[1], 1.0) << "row-major";
  EXPECT_DOUBLE_EQ(message.pose_covariance_body[6], 6.0);
}

TEST(OdometryMessage, InvalidHoldsPoseButNoMeasurement) {
  PairResult result = validResult();
  result.estimate.valid = false;
  result.estimate.reasons = vo::OdometryReason::too_few_matches;
  result.estimate.reasons.add(vo::OdometryReason::high_residual);
  const odometry_t message = odometryMessage(result);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, bits(odometry_t::REASON_TOO_FEW_MATCHES, odometry_t::REASON_HIGH_RESIDUAL));
  EXPECT_DOUBLE_EQ(message.position_world_body[0], 1.0);
  for (const double value : message.velocity_body)
    EXPECT_TRUE(std::isnan(value));
  for (const double value : message.angular_velocity_body)
    EXPECT_TRUE(std::isnan(value));
  for (const double value : message.twist_covariance_body)
    EXPECT_TRUE(std::isnan(value));
  for (const double value : message.pose_covariance_body)
    EXPECT_TRUE(std::isnan(value));
}

TEST(OdometryMessage, IsInvalidWithoutVelocity) {
  PairResult result = validResult();
  result.motion.velocity.setConstant(std::numeric_limits<double>::quiet_NaN());
  const odometry_t message = odometryMessage(result);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, odometry_t::REASON_TIME_STEP);
}

TEST(OdometryMessage, IsInvalidWithAnInstantThatIsStillToCome) {
  lcm::LCM lcm("memq://");
  OdometryPublisher publisher(lcm, std::chrono::milliseconds(200));
  PairResult result = validResult();
  result.left.exposure_ns = result.right.exposure_ns = hostNow() - 50'000'000;
  EXPECT_EQ(publisher.publish(result).status, +odometry_t::VALID);
  result.left.exposure_ns = hostNow() + 50'000'000;
  const odometry_t& message = publisher.publish(result);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, +odometry_t::REASON_OFFSET_UNCERTAIN);
  EXPECT_TRUE(std::isnan(message.velocity_body[0]));
}

TEST(OdometryMessage, OfMissedPairHoldsReasonAndLastPose) {
  const odometry_t last = odometryMessage(validResult());
  const odometry_t message = odometryMessage(NoPair{5'000'000'000, NoPairCause::wrong_size}, last);
  EXPECT_EQ(message.utime, 5'000'000);
  EXPECT_EQ(message.arrival_utime, 0);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, bits(odometry_t::REASON_NO_PAIR, odometry_t::REASON_WRONG_SIZE));
  EXPECT_EQ(message.reset_counter, 3);
  EXPECT_DOUBLE_EQ(message.position_world_body[1], 2.0);
  EXPECT_NEAR(message.orientation_world_body[3], std::sin(0.25), 1e-12);
  EXPECT_TRUE(std::isnan(message.velocity_body[0]));
}

TEST(OdometryMessage, FitsIntoOneEthernetFrame) {
  EXPECT_LE(odometry_t{}.getEncodedSize(), kEthernetFrame);
}

TEST(OdometryMessage, JoinsNamesOfReasons) {
  EXPECT_EQ(reasonNames(bits(odometry_t::REASON_NO_PAIR, odometry_t::REASON_DAMAGED_FRAME)),
            "no pair, damaged frame");
  EXPECT_EQ(reasonNames(0), "");
}

/// The REASON_... constants that odometry_t.lcm declares.
std::map<std::string, std::int32_t> declaredReasons() {
  static const std::regex kReason("REASON_([A-Z_]+) = ([0-9]+)");
  std::ifstream stream(test::sourceFolder() / "daemon/messages/odometry_t.lcm");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::map<std::string, std::int32_t> reasons;
  for (std::sregex_iterator match(text.begin(), text.end(), kReason), end; match != end; ++match) {
    reasons[(*match)[1]] = std::stoi((*match)[2]);
  }
  return reasons;
}

TEST(OdometryMessage, HasNameForEachDeclaredReason) {
  const std::map<std::string, std::int32_t> reasons = declaredReasons();
  ASSERT_EQ(reasons.size(), 16U);
  for (const auto& [name, bit] : reasons) {
    std::string words = name;
    std::transform(words.begin(), words.end(), words.begin(), [](char c) {
      return c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    });
    const std::string expected = name == "WRONG_SIZE" ? "wrong picture size" : words;
    EXPECT_EQ(reasonNames(bit), expected);
  }
}

TEST(OdometryMessage, HasBitForEachOdometryReason) {
  constexpr std::array<std::pair<vo::OdometryReason, std::int32_t>, vo::kOdometryReasonCount> kBits{{
      {vo::OdometryReason::none, 0},
      {vo::OdometryReason::first_pair, 1},
      {vo::OdometryReason::too_few_features, 2},
      {vo::OdometryReason::too_few_matches, 4},
      {vo::OdometryReason::too_few_inliers, 8},
      {vo::OdometryReason::high_residual, 16},
      {vo::OdometryReason::time_step, 32},
      {vo::OdometryReason::implausible_motion, 64},
      {vo::OdometryReason::degenerate_geometry, 128},
      {vo::OdometryReason::zero_velocity, 2048},
      {vo::OdometryReason::offset_uncertain, 4096},
      {vo::OdometryReason::repeated_picture, 8192},
      {vo::OdometryReason::offset_too_large, 16384},
      {vo::OdometryReason::wrong_stereo_geometry, 32768},
  }};
  vo::OdometryReasons all;
  std::int32_t all_bits = 0;
  for (const auto& [reason, bit] : kBits) {
    EXPECT_EQ(reasonBits(reason), bit);
    all.add(reason);
    all_bits |= bit;
  }
  EXPECT_EQ(reasonBits(all), all_bits);
}

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
  PairResult result = validResult();
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

TEST(HealthMessage, SelfCheckGivesTheAdviceWhileThereIsNoFault) {
  HealthMonitor monitor{{}};
  HealthSnapshot unmounted = snapshot(1);
  EXPECT_EQ(monitor.summarise({}, unmounted).self_check, "");
  unmounted.advice = calib::kNoMountText;
  EXPECT_EQ(monitor.summarise({}, unmounted).self_check, calib::kNoMountText);
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
  PairResult result = validResult();
  for (const int features : {1000, 430, 450}) {
    result.features = features;
    monitor.addPair(result, odometryMessage(result));
  }
  const health_t health = monitor.summarise({}, slow);
  EXPECT_EQ(health.features_configured, 1000);
  EXPECT_EQ(health.features_least, 430);
  EXPECT_THAT(health.problem, testing::HasSubstr("430 instead of 1000 features"));
  const health_t without_pairs = monitor.summarise({}, slow);
  EXPECT_EQ(without_pairs.features_least, 1000);
  EXPECT_EQ(without_pairs.problem, "");
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
  PairResult result = validResult();
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
  PairResult result = validResult();
  result.estimate.rig = vo::RigCalibrationError{{0.0, 1e-4}, {0.0, 1e-4}, {0.01, 1e-4}, {3e-3, 1e-4}};
  monitor.addPair(result, odometryMessage(result));
  const health_t health = monitor.summarise({}, snapshot(1));
  EXPECT_FLOAT_EQ(health.right_late_ms, 3.0F);
  EXPECT_FLOAT_EQ(health.right_late_deviation_ms, 0.1F);
  EXPECT_NEAR(health.right_rotation_deg[2], 0.573, 0.001);
  EXPECT_FLOAT_EQ(health.right_rotation_deg[0], 0.0F);
  EXPECT_THAT(health.self_check, testing::HasSubstr("3.0 ± 0.1 ms later"));
}

TEST(HealthMessage, HoldsReadouts) {
  HealthMonitor monitor({}, {0.032, 0.032});
  EXPECT_TRUE(std::isnan(monitor.summarise({}, snapshot(1)).left_readout_ms)) << "not estimated yet";
  PairResult result = validResult();
  result.estimate.readouts = vo::ReadoutEstimates{{0.0321, 1e-4}, {-0.0384, 2e-4}};
  monitor.addPair(result, odometryMessage(result));
  const health_t health = monitor.summarise({}, snapshot(1));
  EXPECT_FLOAT_EQ(health.left_readout_ms, 32.1F);
  EXPECT_FLOAT_EQ(health.left_readout_deviation_ms, 0.1F);
  EXPECT_FLOAT_EQ(health.right_readout_ms, -38.4F);
  EXPECT_FLOAT_EQ(health.right_readout_deviation_ms, 0.2F);
  EXPECT_THAT(health.self_check, testing::HasSubstr("-38.4 ± 0.2 ms, not 32.0 ms"));
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
  constexpr std::size_t kLaterFields = sizeof(std::int8_t) + 4 * sizeof(float);  // odometry_state, readouts
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
  PairResult all_wrong = validResult();
  all_wrong.estimate.rig = vo::RigCalibrationError{{1.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}};
  monitor.addPair(all_wrong, odometryMessage(all_wrong));
  const health_t health = monitor.summarise({}, long_texts);
  EXPECT_EQ(health.problem, std::string(199, 'x')) << "cut before the two-byte character";
  EXPECT_GE(health.self_check.size(), 199U);
  EXPECT_LE(health.getEncodedSize(), kEthernetFrame);
}

}  // namespace
}  // namespace cartvo::daemon
