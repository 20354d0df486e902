// Findings from health messages of a running cartvod.
#include "tools/doctor/network/daemon_checks.hpp"

#include <atomic>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/diagnostics/metrics_server.hpp"
#include "support/closed_port.hpp"
#include "support/doctor/findings.hpp"

namespace cartvo::doctor {
namespace {

using test::findingOf;
using test::Saw;

health_t goodHealth() {
  health_t health{};
  health.version = CARTVO_VERSION;
  health.left.state = health.right.state = camera_health_t::STREAMING;
  health.left.frame_rate = health.right.frame_rate = 18.0F;
  health.left.frames = health.right.frames = 1000;
  health.pair_rate = 18.0F;
  health.process_ms = 7.0F;
  health.latency_p99_ms = 20.0F;
  health.features_configured = health.features_least = 1000;
  health.clock_deviation_ms = 0.7F;
  health.left_readout_ms = health.right_readout_ms = 32.0F;
  health.left_readout_deviation_ms = health.right_readout_deviation_ms = 0.1F;
  return health;
}

Findings checked(const health_t& health) {
  FindingList list("cartvod");
  checkHealth(health, {}, {0.032, 0.032}, list);
  return list.take();
}

Findings checked(const camera_health_t& camera) {
  FindingList list("left camera");
  daemon::Configuration configuration;
  configuration.frame_rate = 18.0;
  checkCameraHealth(camera, configuration, list);
  return list.take();
}

TEST(DaemonChecks, AcceptAHealthyDaemon) {
  EXPECT_EQ(worstVerdict(checked(goodHealth())), Verdict::ok) << areaText(checked(goodHealth()));
  const Findings camera = checked(goodHealth().left);
  EXPECT_EQ(worstVerdict(camera), Verdict::ok) << areaText(camera);
}

TEST(DaemonChecks, NameFramesThatAreInNoPair) {
  health_t health = goodHealth();
  health.dropped_no_partner = 20;
  EXPECT_EQ(worstVerdict(checked(health)), Verdict::ok) << "as at a start";
  health.dropped_out_of_order = 1;
  EXPECT_THAT(findingOf(checked(health), "pairing"),
              Saw(Verdict::look_at, "21 of 2000 (20 without a partner, 1 out of order)"));
}

TEST(DaemonChecks, NameTheStateOfTheOdometry) {
  health_t health = goodHealth();
  health.odometry_state = health_t::STANDSTILL;
  EXPECT_EQ(worstVerdict(checked(health)), Verdict::ok);
  health.odometry_state = health_t::LEFT_FROZEN;
  EXPECT_THAT(findingOf(checked(health), "odometry"), Saw(Verdict::broken, "left camera frozen"));
  health.odometry_state = health_t::LOST;
  EXPECT_THAT(findingOf(checked(health), "odometry"), Saw(Verdict::look_at, "lost"));
}

TEST(DaemonChecks, LookAtProblemsOfTheDaemon) {
  health_t health = goodHealth();
  health.version = "0.0.1";
  health.problem = "the computer is too slow";
  health.self_check = "the right camera is turned";
  health.bound_exceeded = "yaw rate is known to 4.10 deg/s, alert limit 3.00 deg/s";
  health.features_least = 300;
  health.clock_deviation_ms = 20.0F;
  health.right_readout_ms = 27.0F;
  const Findings findings = checked(health);
  EXPECT_THAT(findingOf(findings, "release"), Saw(Verdict::look_at, "0.0.1"));
  EXPECT_THAT(findingOf(findings, "problem"), Saw(Verdict::look_at, "too slow"));
  EXPECT_THAT(findingOf(findings, "self-check"), Saw(Verdict::look_at, "turned"));
  EXPECT_THAT(findingOf(findings, "alert limits"), Saw(Verdict::look_at, "4.10 deg/s"));
  EXPECT_THAT(findingOf(findings, "processing"), Saw(Verdict::look_at, "300 of 1000 features"));
  EXPECT_THAT(findingOf(findings, "time offset"), Saw(Verdict::broken, "deviation 20.0 ms"));
  EXPECT_THAT(findingOf(findings, "readouts while driving"), Saw(Verdict::look_at, "27.0"));
}

TEST(DaemonChecks, DoNotJudgeWhatTheDaemonDoesNotKnow) {
  health_t health = goodHealth();
  health.process_ms = health.offset_ms = health.left_readout_deviation_ms =
      std::numeric_limits<float>::quiet_NaN();
  const Findings findings = checked(health);
  for (const char* subject : {"processing", "time offset", "readouts while driving"})
    EXPECT_EQ(findingOf(findings, subject).verdict, Verdict::not_checked) << subject;
}

TEST(DaemonChecks, SayWhyACameraDoesNotStream) {
  camera_health_t camera = goodHealth().left;
  camera.state = camera_health_t::REFUSED;
  camera.last_error = "refused the user or password";
  EXPECT_THAT(checked(camera).front(),
              Saw(Verdict::broken, "refuses the login, by cartvod: refused the user or password"));
  EXPECT_EQ(checked(camera).size(), 1U);
  camera.state = camera_health_t::FROZEN;
  EXPECT_THAT(checked(camera).front(), Saw(Verdict::broken, "frozen"));
}

TEST(DaemonChecks, LookAtLossesClockAndRate) {
  camera_health_t camera = goodHealth().left;
  camera.damaged = 5;
  camera.clock_steps = 2;
  camera.frame_rate = 15.0F;
  const Findings findings = checked(camera);
  EXPECT_THAT(findingOf(findings, "losses"), Saw(Verdict::look_at, "5 of 1000 frames"));
  EXPECT_THAT(findingOf(findings, "clock"), Saw(Verdict::look_at, "2 times"));
  EXPECT_THAT(findingOf(findings, "frame rate"), Saw(Verdict::look_at, "15.0 Hz"));
}

TEST(DaemonChecks, AskTheHealthPage) {
  const std::atomic<bool> interrupted{false};
  FindingList list("cartvod");
  daemon::Configuration configuration;
  checkHealthPage(configuration, interrupted, list);
  EXPECT_TRUE(list.findings().empty());
  const daemon::MetricsServer server(ListenAddress{"127.0.0.1", 0});
  configuration.metrics = ListenAddress::parse(server.address());
  checkHealthPage(configuration, interrupted, list);
  EXPECT_NE(list.findings().back().verdict, Verdict::not_checked);
  EXPECT_THAT(list.findings().back().seen, testing::StartsWith("200 "));
  const test::ClosedPort closed;
  configuration.metrics = ListenAddress{"127.0.0.1", closed.port()};
  checkHealthPage(configuration, interrupted, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::look_at, "cannot be reached"));
}

}  // namespace
}  // namespace cartvo::doctor
