// Tests of ControllerOdometry: what a control loop gets of late, lost, reordered, repeated, forged, senseless
// and stopped messages, and the ramp to the safe command.

#include <cmath>
#include <limits>

#include <cartvo/client.hpp>
#include <gtest/gtest.h>

#include "support/client/valid_message.hpp"

namespace cartvo::client {
namespace {

using std::chrono::milliseconds;
using test::invalidMessage;
using test::sealed;
using test::validMessage;

constexpr std::int64_t kStart = test::kMessageUtime;
constexpr std::int64_t kFrame_us = 55'556;  // 18 Hz
constexpr std::int64_t kCycle_us = 25'000;  // 40 Hz
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A control loop whose clocks are set by the test.
class ControllerOdometryTest : public testing::Test {
 protected:
  bool add(const odometry_t& message) { return odometry_.add(message, now_, steady_); }
  ControllerInput input() { return odometry_.input(now_, steady_); }

  void advance(std::int64_t time_us) {
    now_ += time_us;
    steady_ += std::chrono::microseconds(time_us);
  }

  /// Cycles without messages for a time; the last input.
  ControllerInput run(std::int64_t time_us) {
    ControllerInput last = input();
    for (std::int64_t passed = 0; passed < time_us; passed += kCycle_us) {
      advance(kCycle_us);
      last = input();
    }
    return last;
  }

  /// Cycles with a fresh message in each, until authority is full.
  void drive() {
    input();
    for (int i = 0; i < 30; ++i) {
      advance(kCycle_us);
      add(validMessage(sequence_++, now_));
      input();
    }
  }

  std::int64_t now_ = kStart;
  SteadyClock::time_point steady_{std::chrono::hours(1)};
  ControllerOdometry odometry_;
  std::int64_t sequence_ = 1;
};

TEST_F(ControllerOdometryTest, WaitsWithTheSafeCommandBeforeTheFirstMessage) {
  const ControllerInput waiting = run(1'000'000);
  EXPECT_EQ(waiting.state, InputState::waiting);
  EXPECT_EQ(waiting.age_us, 0);
  EXPECT_TRUE(std::isnan(waiting.motion.velocity[0]));
  EXPECT_EQ(waiting.command(5.0), 0.0);
  EXPECT_EQ(waiting.command(5.0, -1.0), -1.0);
}

TEST_F(ControllerOdometryTest, RaisesAuthorityWithoutAJump) {
  input();
  double last = 0.0;
  for (int i = 0; i < 20; ++i) {
    advance(kCycle_us);
    add(validMessage(i, now_));
    const ControllerInput rising = input();
    EXPECT_EQ(rising.state, InputState::measured);
    EXPECT_NEAR(rising.authority - last, 0.05, 1e-9) << "0.5 s at 40 Hz";
    EXPECT_NEAR(rising.command(10.0), 10.0 * rising.authority, 1e-12);
    last = rising.authority;
  }
  EXPECT_NEAR(last, 1.0, 1e-9);
}

TEST_F(ControllerOdometryTest, ExtrapolatesToNowForAtMostTheTimeToLive) {
  drive();
  const double start = input().motion.position[0];
  for (std::int64_t age = kCycle_us; age <= test::kTimeToLive_us; age += kCycle_us) {
    advance(kCycle_us);
    const ControllerInput between = input();
    EXPECT_EQ(between.state, InputState::measured);
    EXPECT_EQ(between.age_us, age);
    EXPECT_EQ(between.motion.utime, now_);
    EXPECT_NEAR(between.motion.position[0] - start, 3e-6 * static_cast<double>(age), 1e-9);
    EXPECT_NEAR(std::sqrt(between.motion.twist_covariance[0]), 2e-6 * static_cast<double>(age), 1e-9);
  }
  advance(1);
  EXPECT_EQ(input().state, InputState::ramping);
}

TEST_F(ControllerOdometryTest, RampsToTheSafeCommandWhenMessagesStop) {
  drive();
  run(test::kTimeToLive_us);
  double last = 1.0;
  for (int i = 0; i < 19; ++i) {
    advance(kCycle_us);
    const ControllerInput ramping = input();
    ASSERT_EQ(ramping.state, InputState::ramping);
    EXPECT_NEAR(last - ramping.authority, 0.05, 1e-9) << "1 to 0 in 0.5 s";
    EXPECT_DOUBLE_EQ(ramping.motion.velocity[0], 3.0) << "the last one";
    EXPECT_NEAR(ramping.command(8.0, -2.0), -2.0 + 10.0 * ramping.authority, 1e-12);
    last = ramping.authority;
  }
  const ControllerInput safe = run(50'000);
  EXPECT_EQ(safe.state, InputState::safe);
  EXPECT_EQ(safe.authority, 0.0);
  EXPECT_EQ(safe.command(8.0, -2.0), -2.0);
  EXPECT_TRUE(std::isnan(safe.motion.velocity[0])) << "zero could be taken for a standstill";
  EXPECT_TRUE(std::isnan(safe.motion.twist_covariance[0]));
  EXPECT_GT(safe.motion.position[0], 0.0) << "the last pose";
}

TEST_F(ControllerOdometryTest, RecoversBySlopeFromTheRamp) {
  drive();
  run(500'000);
  const double before = input().authority;
  advance(kCycle_us);
  add(validMessage(sequence_++, now_));
  const ControllerInput again = input();
  EXPECT_EQ(again.state, InputState::measured);
  EXPECT_NEAR(again.authority - before, 0.05, 1e-9);
}

TEST_F(ControllerOdometryTest, AStalledControllerDoesNotJumpToFullAuthority) {
  input();
  advance(5'000'000);
  add(validMessage(1, now_));
  EXPECT_NEAR(input().authority, 0.2, 1e-9) << "100 ms of 500 at most";
}

TEST_F(ControllerOdometryTest, BridgesLostPairsButNotForLongerThanTheTimeToLive) {
  drive();
  for (int i = 0; i < 4; ++i) {
    advance(kFrame_us);
    add(invalidMessage(sequence_++, now_, odometry_t::REASON_NO_PAIR));
    const ControllerInput between = input();
    EXPECT_EQ(between.state, InputState::measured);
    EXPECT_EQ(between.verdict, OdometryVerdict::invalid);
  }
  advance(kFrame_us);
  add(invalidMessage(sequence_++, now_, odometry_t::REASON_NO_PAIR));
  EXPECT_EQ(input().state, InputState::ramping);
}

TEST_F(ControllerOdometryTest, GivesUpTheLastMessageIfItMayBeWrongToo) {
  for (const std::int32_t reason :
       {int{odometry_t::REASON_REPEATED_PICTURE}, int{odometry_t::REASON_WRONG_STEREO_GEOMETRY}}) {
    drive();
    advance(kCycle_us);
    add(invalidMessage(sequence_++, now_, reason));
    EXPECT_EQ(input().state, InputState::ramping) << reason;
  }
}

TEST_F(ControllerOdometryTest, DoesNotUseLateMessages) {
  input();
  for (int i = 0; i < 20; ++i) {
    advance(kCycle_us);
    add(validMessage(i, now_ - test::kTimeToLive_us - 1));
    const ControllerInput late = input();
    EXPECT_EQ(late.state, InputState::waiting);
    EXPECT_EQ(late.verdict, OdometryVerdict::late);
  }
}

TEST_F(ControllerOdometryTest, IgnoresReorderedAndRepeatedMessages) {
  drive();
  const ControllerInput before = input();
  EXPECT_FALSE(add(validMessage(sequence_ - 1, now_)));
  EXPECT_FALSE(add(validMessage(sequence_ - 3, now_ - kFrame_us)));
  EXPECT_EQ(input().motion.utime, before.motion.utime);
  EXPECT_EQ(input().age_us, before.age_us);
  EXPECT_EQ(odometry_.newest().lost(), 0);
}

TEST_F(ControllerOdometryTest, CountsLostMessages) {
  drive();
  sequence_ += 2;
  add(validMessage(sequence_, now_));
  EXPECT_EQ(odometry_.newest().lost(), 2);
  EXPECT_EQ(input().state, InputState::measured);
}

TEST_F(ControllerOdometryTest, DoesNotGoBackToAForgedOldMessageWithANewSequence) {
  drive();
  advance(kCycle_us);
  add(validMessage(1'000'000, now_ - 200'000));
  EXPECT_EQ(input().age_us, kCycle_us) << "young enough, but exposed before the one in use";
  add(validMessage(2'000'000, now_ - 3'600'000'000));
  EXPECT_EQ(input().age_us, kCycle_us);
  EXPECT_EQ(input().verdict, OdometryVerdict::late);
  advance(kCycle_us);
  add(validMessage(sequence_++, now_));
  EXPECT_EQ(input().age_us, 0) << "the true daemon's next message counts";
}

TEST_F(ControllerOdometryTest, DoesNotUseSenselessMessages) {
  drive();
  for (const double value : {kNan, std::numeric_limits<double>::infinity(), 1e9}) {
    odometry_t message = validMessage(sequence_++, now_);
    message.velocity_body[0] = value;
    add(sealed(message));
    const ControllerInput after = input();
    EXPECT_EQ(after.verdict, OdometryVerdict::senseless);
    EXPECT_DOUBLE_EQ(after.motion.velocity[0], 3.0);
  }
  EXPECT_EQ(run(1'000'000).state, InputState::safe);
}

/// Not even what it says of frozen cameras, of its sequence or of an invalid state.
TEST_F(ControllerOdometryTest, LeavesOutMessagesThatAreNotIntact) {
  drive();
  for (odometry_t message : {validMessage(sequence_ + 1000, now_), validMessage(0, now_),
                             invalidMessage(sequence_, now_, odometry_t::REASON_REPEATED_PICTURE)}) {
    message.velocity_body[0] = 1.0;
    EXPECT_FALSE(add(message));
  }
  EXPECT_EQ(odometry_.corrupted(), 3u);
  EXPECT_EQ(odometry_.newest().lost(), 0);
  EXPECT_DOUBLE_EQ(input().motion.velocity[0], 3.0);
  EXPECT_EQ(input().state, InputState::measured);
}

TEST_F(ControllerOdometryTest, TheCommandIsAlwaysFinite) {
  drive();
  EXPECT_EQ(input().command(kNan, 0.5), 0.5);
  EXPECT_EQ(input().command(std::numeric_limits<double>::infinity(), 0.5), 0.5);
}

TEST_F(ControllerOdometryTest, UsesNothingWhileTwoDaemonsPublish) {
  drive();
  for (int i = 0; i < 3; ++i) {
    advance(1000);
    add(validMessage(5'000 + i, now_));
    advance(1000);
    add(validMessage(sequence_++, now_));
  }
  const ControllerInput two = input();
  EXPECT_TRUE(two.two_publishers);
  EXPECT_EQ(two.state, InputState::ramping);
}

TEST_F(ControllerOdometryTest, SurvivesClockSteps) {
  drive();
  now_ += 86'400'000'000;  // a day; the monotonic clock goes on
  EXPECT_EQ(input().state, InputState::ramping);
  EXPECT_EQ(run(600'000).state, InputState::safe);
  now_ -= 2 * 86'400'000'000;
  advance(kCycle_us);
  add(validMessage(sequence_++, now_));
  EXPECT_EQ(input().state, InputState::measured) << "the daemon's clock is this one";
}

TEST_F(ControllerOdometryTest, SaysWhenThePoseBeganAgain) {
  drive();
  const std::int64_t before = input().epoch;
  odometry_t message = validMessage(sequence_++, now_);
  message.reset_counter = 7;
  add(sealed(message));
  EXPECT_EQ(input().epoch, before + 1);
}

TEST_F(ControllerOdometryTest, TheEpochIsThatOfTheMotion) {
  drive();
  const ControllerInput before = input();
  for (int i = 0; i < 3; ++i) {
    advance(kCycle_us);
    odometry_t message = invalidMessage(i, now_, odometry_t::REASON_FIRST_PAIR);
    message.reset_counter = 7;
    EXPECT_TRUE(add(sealed(message))) << "of a daemon that has restarted";
    const ControllerInput between = input();
    EXPECT_EQ(between.state, InputState::measured);
    EXPECT_EQ(between.epoch, before.epoch) << "the motion is still that of the run before";
  }
  EXPECT_EQ(odometry_.newest().epoch(), before.epoch + 1);
  advance(kCycle_us);
  odometry_t message = validMessage(3, now_);
  message.reset_counter = 7;
  add(sealed(message));
  EXPECT_EQ(input().epoch, before.epoch + 1);
}

TEST_F(ControllerOdometryTest, RampsOfNoLengthSwitchAtOnce) {
  ControllerSettings settings;
  settings.ramp_down = settings.ramp_up = milliseconds(0);
  ControllerOdometry odometry(settings);
  odometry.add(validMessage(1, now_), now_, steady_);
  EXPECT_EQ(odometry.input(now_, steady_).authority, 1.0);
  EXPECT_EQ(odometry.input(now_ + 300'000, steady_).state, InputState::safe);
}

}  // namespace
}  // namespace cartvo::client
