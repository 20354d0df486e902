// Text of /metrics and answers of /healthz.

#include "daemon/diagnostics/metrics.hpp"

#include <iterator>
#include <limits>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/file_text.hpp"
#include "support/places.hpp"

namespace cartvo::daemon {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Names of all numbers of a struct in health_t.lcm.
std::vector<std::string> numbersOf(const std::string& struct_name) {
  std::string text = test::contentsOf(test::sourceFolder() / "daemon/messages/health_t.lcm");
  text.erase(0, text.find("struct " + struct_name));
  text.erase(text.find('}'));
  static const std::regex kNumber(R"(\n +(int8_t|int32_t|int64_t|float|double) +([a-z0-9_]+)(\[[0-9]\])?;)");
  std::vector<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), kNumber), end; match != end; ++match)
    names.push_back((*match)[2]);
  return names;
}

TEST(MetricsText, HasEachNumberOfTheHealthMessage) {
  const std::string text = metricsText({}, {});
  const std::vector<std::string> of_daemon = numbersOf("health_t"), of_camera = numbersOf("camera_health_t");
  EXPECT_EQ(of_daemon.size(), 32U);
  EXPECT_EQ(of_camera.size(), 10U);
  for (const std::string& name : of_daemon)
    EXPECT_THAT(text, testing::ContainsRegex("\ncartvo_" + name + "[{ ]"));
  for (const std::string& name : of_camera) {
    EXPECT_THAT(text, HasSubstr("\ncartvo_camera_" + name + "{camera=\"left\"} "));
    EXPECT_THAT(text, HasSubstr("\ncartvo_camera_" + name + "{camera=\"right\"} "));
  }
}

TEST(MetricsText, HoldsTheValues) {
  health_t health{};
  health.version = "1.2.3";
  health.pairs = 123'456'789'012;
  health.pair_rate = 17.5F;
  health.clock_by_reports_ms = std::numeric_limits<float>::quiet_NaN();
  health.right.frame_rate = 18.25F;
  health.right.state = camera_health_t::STALLED;
  health.right_rotation_deg[1] = -0.5F;
  health.problem = "text of an operator \" with quotes";
  const std::string text = metricsText(health, {});
  EXPECT_THAT(text, HasSubstr("cartvo_info{version=\"1.2.3\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE cartvo_pairs counter\ncartvo_pairs 123456789012\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_pair_rate 17.5\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_clock_by_reports_ms NaN\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_camera_frame_rate{camera=\"right\"} 18.25\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_camera_state{camera=\"right\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_right_rotation_deg{axis=\"yaw\"} -0.5\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_has_problem 1\n"));
  EXPECT_THAT(text, Not(HasSubstr("operator")));
}

TEST(MetricsText, EachLineIsOfPrometheusFormat) {
  static const std::regex kLine(
      R"re(# TYPE [a-z0-9_]+ (counter|gauge|histogram)|[a-z0-9_]+(\{[a-z]+="[^"]*"\})? (NaN|[+-]?[0-9.e+-]+))re");
  std::istringstream lines(metricsText({}, {}));
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(std::regex_match(line, kLine)) << line;
}

TEST(MetricsText, SumsTimesOfPairs) {
  pipeline::PairResult result;
  result.left = {{1'000'000'000}, 1'050'000'000, 1'054'000'000, 1};
  result.right = {{1'000'000'000}, 1'051'000'000, 1'053'000'000, 1};
  result.times.total = 0.005;
  result.times.stages[static_cast<std::size_t>(vo::Stage::detect)] = 0.002;
  odometry_t message{};
  message.arrival_utime = 1'051'000;
  message.publication_utime = 1'061'000;
  message.quality = 0;
  result.level.motion = Eigen::Vector3d(0.125, 0.25, 0.5);
  result.worst = pipeline::LimitedBound{pipeline::BoundedQuantity::motion, 2, 0.5, 0.15};
  PairTotals totals;
  totals.add(result, message);
  totals.add(result, message);
  EXPECT_EQ(totals.pairs, 2U);
  EXPECT_NEAR(totals.queue, 2 * (0.010 - 0.003 - 0.005), 1e-12) << "latency without decoding and processing";
  const std::string text = metricsText({}, totals);
  EXPECT_THAT(text, HasSubstr("cartvo_processed_pairs 2\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_pairs_above_alert_limit 2\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_motion_bound{axis=\"y\"} 0.25\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_velocity_bound{axis=\"x\"} NaN\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_quality 0\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_process_seconds 0.01\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_stage_seconds{stage=\"detect\"} 0.004\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_decode_seconds{camera=\"left\"} 0.008\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_latency_seconds_bucket{le=\"0.005\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_latency_seconds_bucket{le=\"0.02\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_latency_seconds_bucket{le=\"+Inf\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("cartvo_latency_seconds_count 2\n"));
}

class HealthAnswerTest : public testing::Test {
 protected:
  HealthAnswerTest() {
    state_.last_message = state_.last_valid = now_;
    state_.health.left.state = state_.health.right.state = camera_health_t::STREAMING;
  }
  HealthAnswer answer() { return healthAnswer(state_, now_); }

  DaemonState::Clock::time_point now_{std::chrono::hours(1)};
  DaemonState state_;
};

TEST_F(HealthAnswerTest, IsHealthyWhileOdometryIsValid) {
  EXPECT_TRUE(answer().is_healthy);
  EXPECT_EQ(answer().line, "valid");
  state_.last_valid -= milliseconds(1000);
  EXPECT_TRUE(answer().is_healthy) << "one lost pair is not a fault";
}

TEST_F(HealthAnswerTest, IsHealthyWhileItWaitsForACamera) {
  state_.last_valid -= std::chrono::hours(1);
  state_.health.right.state = camera_health_t::STALLED;
  EXPECT_TRUE(answer().is_healthy);
  EXPECT_EQ(answer().line, "waiting for the right camera");
  state_.health.left.state = camera_health_t::CONNECTING;
  state_.health.problem = "left camera: no route to host";
  EXPECT_EQ(answer().line, "waiting for both cameras: left camera: no route to host");
}

TEST_F(HealthAnswerTest, IsNotHealthyWhileACameraRefusesTheLogin) {
  state_.last_valid -= std::chrono::hours(1);
  state_.health.left.state = camera_health_t::REFUSED;
  state_.health.right.state = camera_health_t::CONNECTING;
  state_.health.problem = "left camera: the camera refused the password";
  EXPECT_FALSE(answer().is_healthy);
  EXPECT_THAT(answer().line, HasSubstr("refused the password"));
}

TEST_F(HealthAnswerTest, IsNotHealthyWhilePicturesGiveNoMotion) {
  state_.last_valid -= milliseconds(1001);
  state_.reasons = odometry_t::REASON_TOO_FEW_FEATURES;
  state_.health.odometry_state = health_t::LOST;
  EXPECT_FALSE(answer().is_healthy);
  EXPECT_EQ(answer().line, "invalid (too few features; lost)");
}

TEST_F(HealthAnswerTest, IsNotHealthyWithAStalledStage) {
  state_.stalled = "left camera's reader";
  EXPECT_FALSE(answer().is_healthy);
  EXPECT_EQ(answer().line, "stalled: the left camera's reader makes no progress");
  state_.stalled.clear();
  state_.last_message -= std::chrono::seconds(10);
  EXPECT_FALSE(answer().is_healthy);
  EXPECT_THAT(answer().line, StartsWith("stalled: no odometry message for 10 s"));
}

TEST_F(HealthAnswerTest, IsReadyOnlyWithOdometryAndBothCameras) {
  state_.health.left.state = state_.health.right.state = camera_health_t::STREAMING;
  EXPECT_TRUE(readyAnswer(state_, now_).is_healthy);
  state_.health.right.state = camera_health_t::STALLED;
  state_.health.right.last_error = "no data for 1 s";
  EXPECT_FALSE(readyAnswer(state_, now_).is_healthy) << "the last estimate may still be VALID";
  EXPECT_EQ(readyAnswer(state_, now_).line, "the right camera is stalled: no data for 1 s");
  state_.health.right.state = camera_health_t::STREAMING;
  state_.last_valid -= milliseconds(1001);
  EXPECT_FALSE(readyAnswer(state_, now_).is_healthy);
}

}  // namespace
}  // namespace cartvo::daemon
