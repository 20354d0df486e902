// Tests of the checks of one message: what makes it unusable.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include <cartvo/client.hpp>
#include <gtest/gtest.h>

#include "support/client/valid_message.hpp"

namespace cartvo::client {
namespace {

using test::sealed;
using test::validMessage;

constexpr std::int64_t kNow = test::kMessageUtime;
constexpr std::int64_t kSmallest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(OdometryCheck, IsUsableWhileValidAndFresh) {
  EXPECT_EQ(judge(validMessage(), kNow + 250'000), OdometryVerdict::usable);
  EXPECT_EQ(judge(validMessage(), kNow + 250'001), OdometryVerdict::late);
  EXPECT_EQ(judge(validMessage(), kNow - 10'001), OdometryVerdict::future) << "the clock was set back";
  EXPECT_EQ(judge(test::invalidMessage(2, kNow, 0), kNow), OdometryVerdict::invalid);
  EXPECT_EQ(judge(odometry_t{}, 0), OdometryVerdict::invalid) << "before the first message";
}

TEST(OdometryCheck, SurvivesTheExtremesOfNumbers) {
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
  const std::array<double* (*)(odometry_t&), 10> fields{
      [](odometry_t& m) { return &m.velocity_bound[0]; },
      [](odometry_t& m) { return &m.angular_rate_bound[1]; },
      [](odometry_t& m) { return &m.motion_bound[2]; },
      [](odometry_t& m) { return &m.rotation_bound[0]; },
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
  EXPECT_EQ(judge(sealed(message), kNow), OdometryVerdict::usable);
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

TEST(OdometryCheck, RefusesABoundAboveTheControllersOwnLimit) {
  const odometry_t message = validMessage();
  OdometryLimits limits;
  limits.velocity_bound = message.velocity_bound[0];
  limits.angular_rate_bound = message.angular_rate_bound[0];
  limits.motion_bound = message.motion_bound[0];
  limits.rotation_bound = message.rotation_bound[0];
  EXPECT_EQ(judge(message, kNow, limits), OdometryVerdict::usable);
  for (double OdometryLimits::*limit : {&OdometryLimits::velocity_bound, &OdometryLimits::angular_rate_bound,
                                        &OdometryLimits::motion_bound, &OdometryLimits::rotation_bound}) {
    OdometryLimits lower = limits;
    lower.*limit *= 0.999;
    EXPECT_EQ(judge(message, kNow, lower), OdometryVerdict::uncertain);
  }
  odometry_t without_quality = message;
  without_quality.quality = 0;
  EXPECT_EQ(judge(without_quality, kNow), OdometryVerdict::contradicted);
}

TEST(OdometryCheck, BoundsTimeToLiveAndAge) {
  odometry_t message = validMessage();
  for (const std::int64_t time_to_live : {kSmallest, std::int64_t{-1}, std::int64_t{0}, kLargest}) {
    message.time_to_live_us = time_to_live;
    EXPECT_EQ(judge(message, kNow), OdometryVerdict::senseless) << time_to_live;
  }
  message.time_to_live_us = 5'000'000;
  message = sealed(message);
  EXPECT_EQ(judge(message, kNow + 1'000'000), OdometryVerdict::usable);
  EXPECT_EQ(judge(message, kNow + 1'000'001), OdometryVerdict::late) << "the controller's own limit";
  EXPECT_EQ(judge(message, kNow - 10'000), OdometryVerdict::usable) << "clocks of two computers";
  EXPECT_EQ(judge(message, kNow - 10'001), OdometryVerdict::future);
}

using Bytes = std::vector<std::uint8_t>;

Bytes encoded(const odometry_t& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// The verdict on bytes as a controller receives them; those that are no message count as corrupted.
OdometryVerdict judgeBytes(const Bytes& bytes) {
  odometry_t message{};
  const auto size = static_cast<int>(bytes.size());
  return message.decode(bytes.data(), 0, size) == size ? judge(message, kNow) : OdometryVerdict::corrupted;
}

TEST(OdometryCheck, RefusesEachFlippedBit) {
  const Bytes intact = encoded(validMessage());
  ASSERT_EQ(judgeBytes(intact), OdometryVerdict::usable);
  for (std::size_t bit = 0; bit < 8 * intact.size(); ++bit) {
    Bytes bytes = intact;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    ASSERT_NE(judgeBytes(bytes), OdometryVerdict::usable) << bit;
  }
}

/// A CRC misses one of 2^32 random changes; these are the same at each run.
TEST(OdometryCheck, RefusesDamagedAndMixedMessages) {
  std::mt19937 random(1);
  const auto below = [&](std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  };
  const Bytes intact = encoded(validMessage()), other = encoded(validMessage(2, kNow + 50'000));
  for (int i = 0; i < 200'000; ++i) {
    Bytes bytes = intact;
    const std::size_t from = below(bytes.size()), to = from + 1 + below(bytes.size() - from);
    if (i % 2 == 0) {  // as of two messages
      std::copy(other.begin() + static_cast<std::ptrdiff_t>(from),
                other.begin() + static_cast<std::ptrdiff_t>(to),
                bytes.begin() + static_cast<std::ptrdiff_t>(from));
    } else {
      for (std::size_t at = from; at < to; ++at)
        bytes[at] = static_cast<std::uint8_t>(random());
    }
    if (bytes == intact || bytes == other) continue;
    ASSERT_NE(judgeBytes(bytes), OdometryVerdict::usable) << i;
  }
}

}  // namespace
}  // namespace cartvo::client
