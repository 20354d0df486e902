// Tests of LatestOdometry: the newest message, what makes one unusable, lost and repeated messages.
#include "tools/subscribers/latest_odometry.hpp"

#include <array>
#include <cstdlib>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;

constexpr std::int64_t kSmallest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::chrono::milliseconds kSilence{100};

odometry_t validMessage(std::int64_t sequence = 1, std::int64_t utime = kNow) {
  odometry_t message{};
  message.sequence = sequence;
  message.utime = utime;
  message.publication_utime = utime > kLargest - 20'000 ? utime : utime + 20'000;
  message.time_to_live_us = 250'000;
  message.status = odometry_t::VALID;
  message.orientation_world_body[0] = 1.0;
  message.velocity_body[0] = 3.0;
  return message;
}

class LatestOdometryTest : public testing::Test {
 protected:
  void publish(const odometry_t& message) { lcm_.publish("CARTVO_ODOMETRY", &message); }
  void publish(std::int64_t sequence, std::int64_t utime, std::int8_t status) {
    odometry_t message = validMessage(sequence, utime);
    message.status = status;
    publish(message);
  }

  void subscribeToOther() { lcm_.subscribe("OTHER", &LatestOdometryTest::onOther, this); }
  void onOther(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
               const odometry_t* /*message*/) {}

  lcm::LCM lcm_{"memq://"};
  LatestOdometry odometry_{lcm_, kSilence};
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
  EXPECT_FALSE(odometry_.isUsable(kNow - 10'001)) << "in the future: the clock was set back";
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
  publish(0, kNow + 1, odometry_t::VALID);
  odometry_.update(100);
  EXPECT_EQ(odometry_.lost(), 0);
}

TEST_F(LatestOdometryTest, IgnoresLateAndRepeatedMessages) {
  publish(5, kNow + 5, odometry_t::VALID);
  publish(4, kNow + 4, odometry_t::VALID);
  publish(5, kNow + 5, odometry_t::VALID);
  ASSERT_TRUE(odometry_.update(100));
  EXPECT_EQ(odometry_.message().sequence, 5);
  EXPECT_EQ(odometry_.lost(), 0);
  EXPECT_EQ(odometry_.ignored(), 2u);
  publish(5, kNow + 5, odometry_t::VALID);
  EXPECT_FALSE(odometry_.update(10)) << "a repeated message is no sign of a running daemon";
}

TEST_F(LatestOdometryTest, AcceptsARestartWhoseClockWasSetBackAfterASilence) {
  publish(5, kNow, odometry_t::VALID);
  ASSERT_TRUE(odometry_.update(100));
  publish(0, kNow - 3'600'000'000, odometry_t::VALID);
  EXPECT_FALSE(odometry_.update(10));
  std::this_thread::sleep_for(kSilence + std::chrono::milliseconds(20));
  publish(1, kNow - 3'600'000'000, odometry_t::VALID);
  EXPECT_TRUE(odometry_.update(100));
  EXPECT_EQ(odometry_.message().sequence, 1);
}

TEST_F(LatestOdometryTest, IsNotUsableWhileTwoDaemonsPublish) {
  for (int i = 0; i < 3; ++i) {
    publish(1000 + i, kNow + 2 * i, odometry_t::VALID);
    publish(5 + i, kNow + 2 * i + 1, odometry_t::VALID);
  }
  ASSERT_TRUE(odometry_.update(100));
  EXPECT_TRUE(odometry_.hasTwoPublishers());
  EXPECT_FALSE(odometry_.isUsable(kNow + 10));
}

TEST_F(LatestOdometryTest, CountsMessagesOfAnotherDefinition) {
  const std::array<std::uint8_t, 40> other{0x12, 0x34};
  lcm_.publish("CARTVO_ODOMETRY", other.data(), other.size());
  EXPECT_FALSE(odometry_.update(10));
  EXPECT_EQ(odometry_.undecodable(), 1u);
}

TEST_F(LatestOdometryTest, SurvivesTheExtremesOfNumbers) {
  for (const std::int64_t sequence : {kSmallest, kLargest, std::int64_t{0}, kSmallest, kLargest}) {
    odometry_t message = validMessage(sequence);
    message.publication_utime = sequence;
    publish(message);
  }
  odometry_.update(100);
  for (const std::int64_t utime : {kSmallest, kSmallest + 1, std::int64_t{-1}, kLargest}) {
    for (const std::int64_t now : {kSmallest, std::int64_t{0}, kNow, kLargest}) {
      const odometry_t message = validMessage(1, utime);
      EXPECT_EQ(judge(message, now) == OdometryVerdict::usable, std::abs(now / 2 - utime / 2) < 2)
          << utime << " at " << now;
    }
  }
}

TEST(OdometryCheck, RefusesWhatAValidMessageCannotHold) {
  ASSERT_EQ(judge(validMessage(), kNow), OdometryVerdict::usable);
  const std::array<double* (*)(odometry_t&), 6> fields{
      [](odometry_t& m) { return &m.velocity_body[1]; },
      [](odometry_t& m) { return &m.angular_velocity_body[2]; },
      [](odometry_t& m) { return &m.position_world_body[0]; },
      [](odometry_t& m) { return &m.orientation_world_body[3]; },
      [](odometry_t& m) { return &m.twist_covariance_body[7]; },
      [](odometry_t& m) { return &m.pose_covariance_body[35]; }};
  for (std::size_t field = 0; field < fields.size(); ++field) {
    for (const double value : {kNan, kInfinity, -kInfinity, 1e300, -1e300}) {
      odometry_t message = validMessage();
      *fields[field](message) = value;
      EXPECT_EQ(judge(message, kNow), OdometryVerdict::senseless) << "field " << field << ", " << value;
    }
  }
  odometry_t message = validMessage();
  message.twist_covariance_body[0] = -1e-9;
  EXPECT_EQ(judge(message, kNow), OdometryVerdict::senseless) << "a negative variance";
  message = validMessage();
  message.orientation_world_body[0] = 0.0;
  EXPECT_EQ(judge(message, kNow), OdometryVerdict::senseless) << "no rotation";
}

TEST(OdometryCheck, RefusesAValidMessageWithAReasonAgainstIt) {
  odometry_t message = validMessage();
  message.reasons = odometry_t::REASON_ZERO_VELOCITY;
  EXPECT_EQ(judge(message, kNow), OdometryVerdict::usable);
  const std::array<std::int32_t, 5> against{
      odometry_t::REASON_NO_PAIR, odometry_t::REASON_REPEATED_PICTURE,
      (+odometry_t::REASON_ZERO_VELOCITY) | (+odometry_t::REASON_HIGH_RESIDUAL), 1 << 30, -1};
  for (const std::int32_t reasons : against) {
    message.reasons = reasons;
    EXPECT_EQ(judge(message, kNow), OdometryVerdict::contradicted) << reasons;
  }
  message.reasons = 0;
  for (const int status : {2, -1, 127, -128}) {
    message.status = static_cast<std::int8_t>(status);
    EXPECT_EQ(judge(message, kNow), OdometryVerdict::contradicted) << status;
  }
}

TEST(OdometryCheck, BoundsTimeToLiveAndAge) {
  odometry_t message = validMessage();
  for (const std::int64_t time_to_live : {kSmallest, std::int64_t{-1}, std::int64_t{0}, kLargest}) {
    message.time_to_live_us = time_to_live;
    EXPECT_EQ(judge(message, kNow), OdometryVerdict::senseless) << time_to_live;
  }
  message.time_to_live_us = 5'000'000;
  EXPECT_EQ(judge(message, kNow + 1'000'000), OdometryVerdict::usable);
  EXPECT_EQ(judge(message, kNow + 1'000'001), OdometryVerdict::late) << "the controller's own limit";
  EXPECT_EQ(judge(message, kNow - 10'000), OdometryVerdict::usable) << "clocks of two computers";
  EXPECT_EQ(judge(message, kNow - 10'001), OdometryVerdict::future);
}

}  // namespace
}  // namespace cartvo
