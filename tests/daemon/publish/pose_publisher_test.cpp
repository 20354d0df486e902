// bot_core.pose_t: fingerprint, both meanings of the velocity, silence while the odometry is invalid.

#include "daemon/publish/pose_publisher.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/daemon/sent_messages.hpp"

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

TEST(PosePublisher, SendsValidPosesOnly) {
  test::SentMessages sent;
  PosePublisher publisher(sent, "POSE_BODY", PoseVelocity::body);
  odometry_t message = turnedCart();
  publisher.publish(message);
  message.status = odometry_t::INVALID;
  publisher.publish(message);
  const std::vector<bot_core::pose_t> poses = sent.on<bot_core::pose_t>("POSE_BODY");
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses.front().vel[0], 4.0);
}

TEST(PosePublisher, IsOffWithoutAChannel) {
  test::SentMessages sent;
  PosePublisher publisher(sent, "", PoseVelocity::body);
  publisher.publish(turnedCart());
  EXPECT_EQ(sent.count(), 0U);
}

}  // namespace
}  // namespace cartvo::daemon
