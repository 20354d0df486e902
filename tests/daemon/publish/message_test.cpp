// Odometry messages: fields of valid and invalid ones, their size, and the names of their reasons.
#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include <cartvo/client.hpp>
#include <gtest/gtest.h>

#include "common/host_clock.hpp"
#include "daemon/publish/message_names.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "daemon/publish/pose_publisher.hpp"
#include "support/daemon/sent_messages.hpp"
#include "support/file_text.hpp"
#include "support/pipeline/valid_result.hpp"
#include "support/places.hpp"

namespace cartvo::daemon {
namespace {

using test::kEthernetFrame;
using test::validResult;

constexpr std::int32_t bits(std::int32_t first, std::int32_t second) {
  return first | second;
}

TEST(OdometryMessage, HoldsEstimateInMicrosecondsAndBodyAxes) {
  const odometry_t message = odometryMessage(validResult());
  EXPECT_EQ(message.utime, 1'000'000'500);
  EXPECT_EQ(message.arrival_utime, 1'000'021'000) << "the later of the two last packets";
  EXPECT_EQ(message.offset_us, 3'000);
  EXPECT_EQ(message.status, +odometry_t::VALID);
  EXPECT_EQ(message.reasons, 0);
  EXPECT_EQ(message.reset_counter, 3);
  EXPECT_EQ(message.features, 900);
  EXPECT_EQ(message.tracked, 800);
  EXPECT_EQ(message.inliers, 600);
  EXPECT_DOUBLE_EQ(message.position_world_body[2], 3.0);
  EXPECT_NEAR(message.orientation_world_body[0], std::cos(0.25), 1e-12) << "w comes first";
  EXPECT_NEAR(message.orientation_world_body[3], std::sin(0.25), 1e-12);
  EXPECT_DOUBLE_EQ(message.velocity_body[0], 4.0);
  EXPECT_DOUBLE_EQ(message.angular_velocity_body[2], 0.3);
  EXPECT_DOUBLE_EQ(message.pose_covariance_body[1], 1.0) << "row-major";
  EXPECT_DOUBLE_EQ(message.pose_covariance_body[6], 6.0);
  EXPECT_DOUBLE_EQ(message.velocity_bound[0], 0.04);
  EXPECT_DOUBLE_EQ(message.angular_rate_bound[1], 0.002);
  EXPECT_DOUBLE_EQ(message.motion_bound[2], 0.03);
  EXPECT_DOUBLE_EQ(message.rotation_bound[0], 0.002);
  EXPECT_EQ(message.quality, 77) << "0.006 rad of 1.5 deg";
  EXPECT_EQ(message.source_id, 0) << "a replay's";
  EXPECT_DOUBLE_EQ(message.acceleration_body[1], 0.5);
  EXPECT_DOUBLE_EQ(message.acceleration_covariance_body[8], 0.09);
}

TEST(OdometryMessage, ThatExceedsAnAlertLimitShowsTheBoundsAlone) {
  pipeline::PairResult result = validResult();
  result.level.rotation.z() = 0.027;
  result.worst = pipeline::worstBound(result.level, {});
  const odometry_t message = odometryMessage(result);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, +odometry_t::REASON_BOUND);
  EXPECT_EQ(message.quality, 0);
  EXPECT_DOUBLE_EQ(message.rotation_bound[2], 0.027);
  EXPECT_DOUBLE_EQ(message.velocity_bound[2], 0.12);
  EXPECT_DOUBLE_EQ(message.position_world_body[0], 1.0) << "the pose goes on";
  for (const double value : {message.velocity_body[0], message.angular_velocity_body[2],
                             message.twist_covariance_body[0], message.pose_covariance_body[0]})
    EXPECT_TRUE(std::isnan(value));
}

TEST(OdometryMessage, ComesBackFromItsBytes) {
  const odometry_t message = odometryMessage(validResult());
  std::vector<unsigned char> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  ASSERT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  odometry_t decoded{};
  ASSERT_EQ(decoded.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  EXPECT_EQ(decoded.quality, message.quality);
  EXPECT_DOUBLE_EQ(decoded.velocity_bound[2], message.velocity_bound[2]);
  EXPECT_DOUBLE_EQ(decoded.rotation_bound[2], message.rotation_bound[2]);
  EXPECT_EQ(decoded.inliers, 600);
}

TEST(OdometryMessage, NamesItsSourceByANumberOfItsOwn) {
  test::SentMessages sent;
  OdometryPublisher first(sent, std::chrono::milliseconds(200)), second(sent, std::chrono::milliseconds(200));
  const std::int64_t id = first.publish(validResult()).source_id;
  EXPECT_GT(id, 0);
  EXPECT_EQ(first.publish(pipeline::NoPair{}).source_id, id);
  EXPECT_TRUE(client::isIntact(first.publish(validResult())));
  EXPECT_NE(second.publish(validResult()).source_id, id);
}

TEST(OdometryMessage, InvalidHoldsPoseButNoMeasurement) {
  pipeline::PairResult result = validResult();
  result.estimate.valid = false;
  result.estimate.reasons = vo::OdometryReason::too_few_matches;
  result.estimate.reasons.add(vo::OdometryReason::high_residual);
  const odometry_t message = odometryMessage(result);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, bits(odometry_t::REASON_TOO_FEW_MATCHES, odometry_t::REASON_HIGH_RESIDUAL));
  EXPECT_DOUBLE_EQ(message.position_world_body[0], 1.0);
  for (const double value : message.velocity_body)
    EXPECT_TRUE(std::isnan(value));
  for (const double value : message.angular_velocity_body)
    EXPECT_TRUE(std::isnan(value));
  for (const double value : message.twist_covariance_body)
    EXPECT_TRUE(std::isnan(value));
  for (const double value : message.pose_covariance_body)
    EXPECT_TRUE(std::isnan(value));
  for (const double value :
       {message.velocity_bound[0], message.angular_rate_bound[1], message.motion_bound[2],
        message.rotation_bound[0], message.acceleration_body[0]})
    EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(message.quality, 0);
}

TEST(OdometryMessage, IsInvalidWithoutVelocity) {
  pipeline::PairResult result = validResult();
  result.motion.velocity.setConstant(std::numeric_limits<double>::quiet_NaN());
  result.worst.reset();
  const odometry_t message = odometryMessage(result);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, odometry_t::REASON_TIME_STEP);
}

TEST(OdometryMessage, IsInvalidWithAnInstantThatIsStillToCome) {
  test::SentMessages sent;
  OdometryPublisher publisher(sent, std::chrono::milliseconds(200));
  pipeline::PairResult result = validResult();
  result.left.exposure_ns = result.right.exposure_ns = hostNow() - 50'000'000;
  EXPECT_EQ(publisher.publish(result).status, +odometry_t::VALID);
  result.left.exposure_ns = hostNow() + 50'000'000;
  const odometry_t& message = publisher.publish(result);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, +odometry_t::REASON_OFFSET_UNCERTAIN);
  EXPECT_TRUE(std::isnan(message.velocity_body[0]));
}

TEST(OdometryMessage, OfMissedPairHoldsReasonAndLastPose) {
  const odometry_t last = odometryMessage(validResult());
  const odometry_t message =
      odometryMessage(pipeline::NoPair{5'000'000'000, pipeline::NoPairCause::wrong_size}, last);
  EXPECT_EQ(message.utime, 5'000'000);
  EXPECT_EQ(message.arrival_utime, 0);
  EXPECT_EQ(message.status, +odometry_t::INVALID);
  EXPECT_EQ(message.reasons, bits(odometry_t::REASON_NO_PAIR, odometry_t::REASON_WRONG_SIZE));
  EXPECT_EQ(message.reset_counter, 3);
  EXPECT_DOUBLE_EQ(message.position_world_body[1], 2.0);
  EXPECT_NEAR(message.orientation_world_body[3], std::sin(0.25), 1e-12);
  EXPECT_TRUE(std::isnan(message.velocity_body[0]));
}

TEST(OdometryMessage, FitsIntoOneEthernetFrame) {
  EXPECT_LE(odometry_t{}.getEncodedSize(), kEthernetFrame);
}

TEST(OdometryMessage, JoinsNamesOfReasons) {
  EXPECT_EQ(reasonNames(bits(odometry_t::REASON_NO_PAIR, odometry_t::REASON_DAMAGED_FRAME)),
            "no pair, damaged frame");
  EXPECT_EQ(reasonNames(0), "");
}

TEST(OdometryReasons, AreThoseOfTheMessageAndOfTheDocumentation) {
  const std::string message = test::contentsOf(test::sourceFolder() / "daemon/messages/odometry_t.lcm");
  std::string list;
  std::uint32_t next = 1;
  for (const vo::OdometryReasonText& text : vo::kOdometryReasons) {
    EXPECT_EQ(vo::OdometryReasons(text.reason).bits(), next) << text.name;
    next *= 2;
    std::string constant = std::string("REASON_") + text.name;
    std::transform(constant.begin(), constant.end(), constant.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    const std::string bit = std::to_string(vo::OdometryReasons(text.reason).bits());
    const std::regex declaration("\\b" + constant + " = " + bit + "\\b");
    EXPECT_TRUE(std::regex_search(message, declaration)) << constant;
    EXPECT_EQ(reasonNames(static_cast<std::int32_t>(text.reason)), text.words);
    list += "- " + bit + " `" + constant + "`: " + text.sentence + ".\n";
  }
  EXPECT_NE(test::contentsOf(test::sourceFolder() / "docs/controllers.md").find(list + "\n"),
            std::string::npos)
      << "docs/controllers.md should contain:\n"
      << list;
  static const std::regex kDeclaration("REASON_[A-Z_]+ = ");
  EXPECT_EQ(std::distance(std::sregex_iterator(message.begin(), message.end(), kDeclaration), {}),
            std::ssize(vo::kOdometryReasons));
}

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
