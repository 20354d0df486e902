// bot_core.pose_t: fingerprint, both meanings of the velocity, silence while the odometry is invalid.

#include "daemon/publish/pose_publisher.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

namespace cartvo::daemon {
namespace {

/// A cart that drives ahead at 4 m/s, to the left of the world's x axis.
odometry_t turnedCart() {
  odometry_t message{};
  message.status = odometry_t::VALID;
  message.utime = 1'234'567;
  message.position_world_body[0] = 10.0;
  message.position_world_body[1] = -2.0;
  message.orientation_world_body[0] = message.orientation_world_body[3] = std::sqrt(0.5);
  message.velocity_body[0] = 4.0;
  message.velocity_body[2] = 0.1;
  message.angular_velocity_body[1] = 0.3;
  return message;
}

TEST(PoseMessage, HasTheFingerprintOfLibbotsType) {
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::pose_t::getHash()), 0x2e16efb052b0105eULL);
}

TEST(PoseMessage, HoldsPoseAndRates) {
  const bot_core::pose_t pose = poseMessage(turnedCart(), PoseVelocity::local);
  EXPECT_EQ(pose.utime, 1'234'567);
  EXPECT_EQ(pose.pos[0], 10.0);
  EXPECT_EQ(pose.pos[1], -2.0);
  EXPECT_EQ(pose.orientation[0], std::sqrt(0.5)) << "w comes first";
  EXPECT_EQ(pose.orientation[3], std::sqrt(0.5));
  EXPECT_EQ(pose.rotation_rate[1], 0.3) << "body axes in both meanings";
  EXPECT_TRUE(std::isnan(pose.accel[0])) << "not measured";
}

TEST(PoseMessage, HoldsTheVelocityInTheChosenAxes) {
  const bot_core::pose_t body = poseMessage(turnedCart(), PoseVelocity::body);
  EXPECT_EQ(body.vel[0], 4.0);
  EXPECT_EQ(body.vel[1], 0.0);
  EXPECT_EQ(body.vel[2], 0.1);
  const bot_core::pose_t local = poseMessage(turnedCart(), PoseVelocity::local);
  EXPECT_NEAR(local.vel[0], 0.0, 1e-12);
  EXPECT_NEAR(local.vel[1], 4.0, 1e-12);
  EXPECT_NEAR(local.vel[2], 0.1, 1e-12);
}

class PosePublisherTest : public testing::Test {
 protected:
  PosePublisherTest() { lcm_.subscribe(".*", &PosePublisherTest::onPose, this); }

  void onPose(const lcm::ReceiveBuffer*, const std::string&, const bot_core::pose_t* pose) {
    received_.push_back(*pose);
  }
  void receiveAll() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }

  lcm::LCM lcm_{"memq://"};
  std::vector<bot_core::pose_t> received_;
};

TEST_F(PosePublisherTest, SendsValidPosesOnly) {
  PosePublisher publisher(lcm_, "POSE_BODY", PoseVelocity::body);
  odometry_t message = turnedCart();
  publisher.publish(message);
  message.status = odometry_t::INVALID;
  publisher.publish(message);
  receiveAll();
  ASSERT_EQ(received_.size(), 1U);
  EXPECT_EQ(received_.front().vel[0], 4.0);
}

TEST_F(PosePublisherTest, IsOffWithoutAChannel) {
  PosePublisher publisher(lcm_, "", PoseVelocity::body);
  publisher.publish(turnedCart());
  receiveAll();
  EXPECT_TRUE(received_.empty());
}

}  // namespace
}  // namespace cartvo::daemon
