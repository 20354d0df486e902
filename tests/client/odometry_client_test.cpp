// Tests of NewestOdometry: lost, reordered and repeated messages, restarted daemons, two daemons, epochs.
// Tests of OdometryClient with LCM's queue in memory.
#include <array>
#include <limits>

#include <cartvo/client.hpp>
#include <gtest/gtest.h>

#include "support/client/valid_message.hpp"

namespace cartvo::client {
namespace {

using std::chrono::milliseconds;
using test::validMessage;

constexpr std::int64_t kNow = test::kMessageUtime;
constexpr std::int64_t kSmallest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();

class NewestOdometryTest : public testing::Test {
 protected:
  bool add(std::int64_t sequence, std::int64_t utime) { return add(validMessage(sequence, utime)); }
  bool add(const odometry_t& message) { return newest_.add(message, time_); }

  SteadyClock::time_point time_{std::chrono::hours(1)};
  NewestOdometry newest_{milliseconds(100)};
};

TEST_F(NewestOdometryTest, CountsLostMessagesUntilTheDaemonRestarts) {
  add(100, kNow);
  add(104, kNow);
  EXPECT_EQ(newest_.lost(), 3) << "101 to 103; messages before the first are not counted";
  add(0, kNow + 1);
  EXPECT_EQ(newest_.lost(), 0);
}

TEST_F(NewestOdometryTest, IgnoresLateAndRepeatedMessages) {
  EXPECT_TRUE(add(5, kNow + 5));
  EXPECT_FALSE(add(4, kNow + 4));
  EXPECT_FALSE(add(5, kNow + 5)) << "a repeated message is no sign of a running daemon";
  EXPECT_EQ(newest_.message().sequence, 5);
  EXPECT_EQ(newest_.lost(), 0);
  EXPECT_EQ(newest_.ignored(), 2u);
  EXPECT_EQ(newest_.kept(), 1u);
}

TEST_F(NewestOdometryTest, AcceptsARestartWhoseClockWasSetBackAfterASilence) {
  add(5, kNow);
  EXPECT_FALSE(add(0, kNow - 3'600'000'000));
  time_ += milliseconds(101);
  EXPECT_TRUE(add(1, kNow - 3'600'000'000));
  EXPECT_EQ(newest_.message().sequence, 1);
}

TEST_F(NewestOdometryTest, FindsTwoDaemonsButNotARestart) {
  add(1000, kNow);
  add(5, kNow + 1);
  EXPECT_FALSE(newest_.hasTwoPublishers(time_)) << "a restarted daemon";
  add(1001, kNow + 2);
  add(6, kNow + 3);
  EXPECT_TRUE(newest_.hasTwoPublishers(time_));
  EXPECT_FALSE(newest_.hasTwoPublishers(time_ + std::chrono::seconds(2))) << "one of them has ended";
}

TEST_F(NewestOdometryTest, TellsTwoDaemonsApartByTheirSource) {
  odometry_t first = validMessage(1000, kNow), other = validMessage(1001, kNow - 50'000);
  first.source_id = 1;
  other.source_id = 2;
  EXPECT_TRUE(add(first));
  EXPECT_FALSE(add(other)) << "published before the newest one, whatever its sequence";
  for (odometry_t* const message : {&other, &first, &other}) {
    message->sequence += 10;
    message->publication_utime = newest_.message().publication_utime + 1000;
    EXPECT_TRUE(add(*message));
  }
  EXPECT_TRUE(newest_.hasTwoPublishers(time_));
  EXPECT_EQ(newest_.epoch(), 3);
}

TEST_F(NewestOdometryTest, CountsEpochsByResetCounterAndRestart) {
  odometry_t message = validMessage(5);
  add(message);
  EXPECT_EQ(newest_.epoch(), 0);
  message.sequence = 6;
  message.reset_counter = 1;
  add(message);
  EXPECT_EQ(newest_.epoch(), 1);
  message.sequence = 7;
  add(message);
  EXPECT_EQ(newest_.epoch(), 1);
  message.sequence = 0;
  ++message.publication_utime;
  add(message);
  EXPECT_EQ(newest_.epoch(), 2) << "a restarted daemon begins a new epoch, also with the same counter";
}

TEST_F(NewestOdometryTest, SurvivesTheExtremesOfNumbers) {
  for (const std::int64_t sequence : {kSmallest, kLargest, std::int64_t{0}, kSmallest, kLargest}) {
    odometry_t message = validMessage(sequence);
    message.publication_utime = sequence;
    add(message);
  }
  EXPECT_EQ(newest_.message().sequence, kLargest);
}

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
