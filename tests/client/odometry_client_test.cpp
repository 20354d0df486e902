// Tests of OdometryClient with LCM's queue in memory.

#include <array>

#include <cartvo/client.hpp>
#include <gtest/gtest.h>

#include "support/client/valid_message.hpp"

namespace cartvo::client {
namespace {

using test::validMessage;

class OdometryClientTest : public testing::Test {
 protected:
  void publish(const odometry_t& message, const char* channel = kOdometryChannel) {
    lcm_.publish(channel, &message);
  }

  void subscribeToOther() { lcm_.subscribe("OTHER", &OdometryClientTest::onOther, this); }
  void onOther(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
               const odometry_t* /*message*/) {}

  lcm::LCM lcm_{"memq://"};
  OdometryClient odometry_{lcm_};
};

TEST_F(OdometryClientTest, WaitsForTheFirstMessage) {
  EXPECT_FALSE(odometry_.update(0));
  EXPECT_EQ(odometry_.input().state, InputState::waiting);
}

TEST_F(OdometryClientTest, IgnoresOtherChannels) {
  subscribeToOther();
  publish({}, "OTHER");
  EXPECT_FALSE(odometry_.update(10));
  publish({}, "OTHER");
  publish(validMessage());
  publish({}, "OTHER");
  EXPECT_TRUE(odometry_.update(100)) << "queued after a message of another channel";
}

TEST_F(OdometryClientTest, DrainsTheQueueAndKeepsTheNewestMessage) {
  for (int i = 0; i < 10; ++i)
    publish(validMessage(i, test::kMessageUtime + i));
  ASSERT_TRUE(odometry_.update(100));
  EXPECT_EQ(odometry_.newest().message().sequence, 9);
  EXPECT_EQ(odometry_.newest().lost(), 0);
  EXPECT_FALSE(odometry_.update(0)) << "nothing is left";
}

TEST_F(OdometryClientTest, MeasuresTheMotionOfNow) {
  publish(validMessage(1, nowUtime() - 30'000));
  ASSERT_TRUE(odometry_.update(100));
  const ControllerInput input = odometry_.input();
  EXPECT_EQ(input.state, InputState::measured);
  EXPECT_GE(input.age_us, 30'000);
  EXPECT_DOUBLE_EQ(input.motion.position[0], 3.0 * 1e-6 * static_cast<double>(input.age_us));
}

TEST_F(OdometryClientTest, CountsMessagesOfAnotherDefinition) {
  const std::array<std::uint8_t, 40> other{0x12, 0x34};
  lcm_.publish(kOdometryChannel, other.data(), other.size());
  EXPECT_FALSE(odometry_.update(10));
  EXPECT_EQ(odometry_.undecodable(), 1u);
}

TEST_F(OdometryClientTest, UnsubscribesAtItsEnd) {
  { const OdometryClient other(lcm_); }
  publish(validMessage());
  EXPECT_TRUE(odometry_.update(100)) << "and the message does not reach the destroyed client";
}

}  // namespace
}  // namespace cartvo::client
