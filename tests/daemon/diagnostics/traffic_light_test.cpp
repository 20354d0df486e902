// The word of the status page: from the newest messages and both cameras.
#include "daemon/diagnostics/traffic_light.hpp"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/publish/message_names.hpp"
#include "support/places.hpp"
#include "vo_core/odometry_reason.hpp"

namespace cartvo::daemon {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

class TrafficLightTest : public testing::Test {
 protected:
  TrafficLightTest() {
    state_.last_message = state_.last_valid = now_;
    state_.health.left.state = state_.health.right.state = camera_health_t::STREAMING;
  }
  TrafficLight light() { return trafficLight(state_, now_); }
  void loseOdometry(std::int32_t reasons) {
    state_.last_valid = now_ - milliseconds(301);
    state_.reasons = reasons;
  }

  DaemonState::Clock::time_point now_{std::chrono::hours(1)};
  DaemonState state_;
};

TEST_F(TrafficLightTest, DrivesOrStandsWhileOdometryIsValid) {
  EXPECT_EQ(light().light, Light::driving);
  EXPECT_EQ(light().cause, "");
  state_.reasons = odometry_t::REASON_ZERO_VELOCITY;
  EXPECT_EQ(light().light, Light::standstill);
  state_.reasons = odometry_t::REASON_NO_PAIR;
  state_.last_valid -= milliseconds(300);
  EXPECT_EQ(light().light, Light::driving) << "one lost pair is not a fault";
  state_.health.odometry_state = health_t::STANDSTILL;
  EXPECT_EQ(light().light, Light::standstill);
  state_.health.self_check = "the right camera is turned";
  EXPECT_EQ(light().topic, "self-check");
  state_.health.problem = "the disk is full";
  EXPECT_EQ(light().cause, "the disk is full");
}

TEST_F(TrafficLightTest, NamesTheCameraThatIsAway) {
  loseOdometry(odometry_t::REASON_NO_PAIR);
  state_.health.right.state = camera_health_t::CONNECTING;
  state_.health.right.last_error = "Connection refused";
  state_.health.problem = "right camera: Connection refused";
  EXPECT_EQ(light().light, Light::no_camera);
  EXPECT_EQ(light().cause, "right camera connecting: Connection refused");
  EXPECT_EQ(light().topic, "camera connecting");
  state_.health.left.state = camera_health_t::STALLED;
  EXPECT_EQ(light().cause, "both cameras connecting: Connection refused") << "the one whose error is known";
  state_.health.left.last_error = "no packet for 3 s";
  EXPECT_EQ(light().cause, "both cameras stalled: no packet for 3 s");
  state_.health.right.state = camera_health_t::STREAMING;
  state_.health.left = {};
  EXPECT_EQ(light().cause, "left camera connecting");
}

TEST_F(TrafficLightTest, SaysWhyPicturesGiveNoMotion) {
  loseOdometry(odometry_t::REASON_TOO_FEW_FEATURES);
  EXPECT_EQ(light().light, Light::invalid);
  EXPECT_THAT(light().cause, HasSubstr("too few features: "));
  EXPECT_EQ(light().topic, "too few features");
  state_.reasons = odometry_t::REASON_NO_PAIR;
  state_.reasons |= odometry_t::REASON_WRONG_SIZE;
  EXPECT_EQ(light().topic, "wrong picture size") << "why there is no pair";
  state_.reasons = odometry_t::REASON_BOUND;
  state_.health.bound_exceeded = "yaw rate is known to 4.10 deg/s, alert limit 3.00 deg/s";
  EXPECT_EQ(light().cause, state_.health.bound_exceeded);
  state_.health.problem = "left camera: covered";
  EXPECT_EQ(light().cause, "left camera: covered");
  state_.health.left.state = camera_health_t::FROZEN;
  EXPECT_EQ(light().light, Light::invalid) << "a frozen camera delivers pictures";
}

TEST_F(TrafficLightTest, SaysThatTheDaemonIsStalledOrSilent) {
  state_.stalled = "left camera's reader";
  EXPECT_EQ(light().light, Light::invalid);
  EXPECT_THAT(light().cause, HasSubstr("the left camera's reader makes no progress"));
  state_.stalled.clear();
  state_.last_message -= milliseconds(4000);
  EXPECT_EQ(light().light, Light::invalid);
  EXPECT_EQ(light().cause, "no odometry message for 4 s");
}

/// The page shows a topic's line as the remedy, so each must stand in the emphasised begin of one.
TEST_F(TrafficLightTest, EachTopicIsTreatedInTroubleshooting) {
  const std::ifstream file(test::sourceFolder() / "docs/troubleshooting.md");
  std::stringstream buffer;
  buffer << file.rdbuf();
  std::string line, labels;
  while (std::getline(buffer, line)) {
    std::erase(line, '`');
    if (line.starts_with("- *")) labels += line.substr(0, line.find("*:")) + "\n";
    if (line.starts_with("## ")) labels += line + "\n";
  }
  for (const vo::OdometryReasonText& text : vo::kOdometryReasons) {
    if (text.reason == vo::OdometryReason::zero_velocity) continue;
    loseOdometry(static_cast<std::int32_t>(text.reason));
    EXPECT_THAT(labels, HasSubstr(light().topic));
  }
  for (const int away : {camera_health_t::CONNECTING, camera_health_t::STALLED, camera_health_t::REFUSED,
                         camera_health_t::ENDED}) {
    state_.health.left.state = static_cast<std::int8_t>(away);
    EXPECT_THAT(labels, HasSubstr(light().topic));
  }
}

}  // namespace
}  // namespace cartvo::daemon
