// Tests of LatestOdometry: the newest message, its validity and age, lost messages.
#include "tools/subscribers/latest_odometry.hpp"

#include <gtest/gtest.h>

namespace cartvo {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;

class LatestOdometryTest : public testing::Test {
 protected:
  void publish(std::int64_t sequence, std::int64_t utime, std::int8_t status) {
    odometry_t message{};
    message.sequence = sequence;
    message.utime = utime;
    message.time_to_live_us = 250'000;
    message.status = status;
    lcm_.publish("CARTVO_ODOMETRY", &message);
  }

  void subscribeToOther() { lcm_.subscribe("OTHER", &LatestOdometryTest::onOther, this); }
  void onOther(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
               const odometry_t* /*message*/) {}

  lcm::LCM lcm_{"memq://"};
  LatestOdometry odometry_{lcm_};
};

TEST_F(LatestOdometryTest, IsNotUsableBeforeTheFirstMessage) {
  EXPECT_FALSE(odometry_.update(0));
  EXPECT_FALSE(odometry_.isUsable(0));
}

TEST_F(LatestOdometryTest, IgnoresOtherChannels) {
  subscribeToOther();
  const odometry_t other{};
  lcm_.publish("OTHER", &other);
  EXPECT_FALSE(odometry_.update(10));
  lcm_.publish("OTHER", &other);
  publish(1, kNow, odometry_t::VALID);
  lcm_.publish("OTHER", &other);
  EXPECT_TRUE(odometry_.update(100)) << "queued after a message of another channel";
}

TEST_F(LatestOdometryTest, IsUsableWhileValidAndFresh) {
  publish(1, kNow, odometry_t::VALID);
  ASSERT_TRUE(odometry_.update(100));
  EXPECT_TRUE(odometry_.isUsable(kNow + 250'000));
  EXPECT_FALSE(odometry_.isUsable(kNow + 250'001)) << "stale";
  EXPECT_FALSE(odometry_.isUsable(kNow - 250'001)) << "in the future: the clock was set back";
  publish(2, kNow, odometry_t::INVALID);
  ASSERT_TRUE(odometry_.update(100));
  EXPECT_FALSE(odometry_.isUsable(kNow));
}

TEST_F(LatestOdometryTest, KeepsTheNewestQueuedMessage) {
  for (int i = 0; i < 10; ++i)
    publish(i, kNow + i, odometry_t::VALID);
  ASSERT_TRUE(odometry_.update(100));
  EXPECT_EQ(odometry_.message().sequence, 9);
  EXPECT_EQ(odometry_.lost(), 0);
}

TEST_F(LatestOdometryTest, CountsLostMessagesUntilTheDaemonRestarts) {
  publish(100, kNow, odometry_t::VALID);
  publish(104, kNow, odometry_t::VALID);
  odometry_.update(100);
  EXPECT_EQ(odometry_.lost(), 3) << "101 to 103; messages before the first are not counted";
  publish(0, kNow, odometry_t::VALID);
  odometry_.update(100);
  EXPECT_EQ(odometry_.lost(), 0);
}

}  // namespace
}  // namespace cartvo
