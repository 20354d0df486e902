// The last minute and the path of the status page, and samples as JSON.
#include "daemon/page/page_history.hpp"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace cartvo::daemon {
namespace {

using Json = nlohmann::json;

odometry_t messageAt(std::int64_t sequence, double seconds, double x) {
  odometry_t message{};
  message.sequence = sequence;
  message.utime = std::llround(1e6 * seconds);
  message.status = odometry_t::VALID;
  message.position_world_body[0] = x;
  message.orientation_world_body[0] = 1.0;
  return message;
}

PageSample sampleAt(std::int64_t sequence, double seconds, double x) {
  return pageSample(messageAt(sequence, seconds, x), 0.01);
}

double field(const PageSample& sample, const std::string& name) {
  for (std::size_t i = 0; i < kSampleFields.size(); ++i)
    if (name == kSampleFields[i]) return sample.values[i];
  ADD_FAILURE() << name;
  return NAN;
}

TEST(PageSample, TurnsTheCovarianceIntoTheWorld) {
  odometry_t message = messageAt(7, 1.0, 2.0);
  message.orientation_world_body[0] = message.orientation_world_body[3] =
      std::sqrt(0.5);                     // 90 deg to the left
  message.pose_covariance_body[0] = 4.0;  // along the body
  message.pose_covariance_body[7] = 1.0;
  message.twist_covariance_body[35] = 0.25;
  message.arrival_utime = 1'000'000;
  message.publication_utime = 1'012'500;
  message.quality = 60;
  message.velocity_bound[0] = 0.12;
  message.angular_rate_bound[2] = 0.03;
  message.motion_bound[1] = 0.05;
  const PageSample sample = pageSample(message, 0.008);
  EXPECT_NEAR(field(sample, "yaw"), std::acos(0.0), 1e-12);
  EXPECT_NEAR(field(sample, "xx"), 1.0, 1e-12);
  EXPECT_NEAR(field(sample, "yy"), 4.0, 1e-12);
  EXPECT_EQ(field(sample, "stddev_yaw_rate"), 0.5);
  EXPECT_EQ(field(sample, "latency_ms"), 12.5);
  EXPECT_EQ(field(sample, "process_ms"), 8.0);
  EXPECT_EQ(field(sample, "quality"), 60.0);
  EXPECT_EQ(field(sample, "bound_speed"), 0.12);
  EXPECT_EQ(field(sample, "bound_yaw_rate"), 0.03);
  EXPECT_EQ(field(sample, "bound_motion"), 0.05) << "the largest of the three axes";
}

TEST(PageSample, NamesEachNumberOnceAndWritesUnknownOnesAsNull) {
  EXPECT_EQ(std::set<std::string>(kSampleFields.begin(), kSampleFields.end()).size(), kSampleFields.size());
  odometry_t message = messageAt(3, 1'700'000'000.123456, 0.0);
  message.velocity_body[0] = std::numeric_limits<double>::quiet_NaN();
  std::string text;
  appendJson(pageSample(message, std::numeric_limits<double>::infinity()), text);
  const Json json = Json::parse(text);
  ASSERT_EQ(json.size(), kSampleFields.size());
  EXPECT_EQ(json[0], 3);
  EXPECT_EQ(json[1], 1'700'000'000'123'456);
  EXPECT_TRUE(json[12].is_null());
  EXPECT_TRUE(json[21].is_null());
}

TEST(PageHistory, KeepsOneMinute) {
  PageHistory history;
  for (int i = 0; i <= 700; ++i)
    history.add(sampleAt(i, 0.1 * i, 0.0));
  EXPECT_EQ(history.size(), 601U);
  EXPECT_EQ(Json::parse(history.json())["samples"][0][0], 100);
  EXPECT_EQ(Json::parse(history.newestJson(3)).size(), 3U);
  EXPECT_EQ(Json::parse(history.newestJson(3))[2][0], 700);
}

TEST(PageHistory, IsBoundedAtHighRatesAndOnLongDrives) {
  PageHistory history;
  for (int i = 0; i < 30'000; ++i)
    history.add(sampleAt(i, 0.001 * i, i));
  EXPECT_EQ(history.size(), PageHistory::kMaxSamples);
  EXPECT_LE(history.pathSize(), PageHistory::kMaxPathPoints);
  EXPECT_GT(history.pathSize(), PageHistory::kMaxPathPoints / 4);
}

TEST(PageHistory, BeginsAnewWhenTheClockIsSetBack) {
  PageHistory history;
  history.add(sampleAt(0, 1000.0, 0.0));
  history.add(sampleAt(1, 100.0, 0.0));
  EXPECT_EQ(history.size(), 1U);
}

TEST(PageHistory, LeavesInvalidPairsOutOfThePath) {
  PageHistory history;
  history.add(sampleAt(0, 1.0, 0.0));
  odometry_t invalid = messageAt(1, 1.1, 5.0);
  invalid.status = odometry_t::INVALID;
  history.add(pageSample(invalid, 0.01));
  EXPECT_EQ(history.pathSize(), 1U);
  EXPECT_EQ(history.size(), 2U);
}

}  // namespace
}  // namespace cartvo::daemon
