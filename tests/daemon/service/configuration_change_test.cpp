// What changes when the configuration is read again: at run time, or at the next restart.

#include "daemon/service/configuration_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cartvo::daemon {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Configuration parse(const std::string& more) {
  return parseConfiguration(
      "cameras:\n  left: {url: rtsp://10.0.0.1/left}\n  right: {url: rtsp://10.0.0.2/right}\nrig: "
      "rig.yaml\n" +
          more,
      "/etc/cartvo/cartvod.yaml");
}

TEST(ConfigurationChange, IsEmptyWithoutADifference) {
  const ConfigurationChange change = compareConfigurations(parse(""), parse("lcm: {time_to_live: 0.25}\n"));
  EXPECT_THAT(change.at_run_time, IsEmpty());
  EXPECT_THAT(change.at_restart, IsEmpty());
  EXPECT_EQ(change.text(), "no value of the configuration has changed");
}

TEST(ConfigurationChange, SeparatesWhatChangesNowFromWhatNeedsARestart) {
  const ConfigurationChange change = compareConfigurations(
      parse("odometry: {features: 500}\n"),
      parse("odometry: {features: 600}\nlcm: {time_to_live: 0.3}\nlogging: {level: debug}\n"
            "metrics: {listen: 9464}\n"));
  EXPECT_THAT(change.at_run_time, ElementsAre("lcm.time_to_live", "logging.level"));
  EXPECT_THAT(change.at_restart, ElementsAre("metrics.listen", "odometry.features"));
  EXPECT_EQ(change.text(),
            "changed: lcm.time_to_live, logging.level; changes with the next restart: metrics.listen, "
            "odometry.features");
}

TEST(ConfigurationChange, FindsKeysThatWereRemoved) {
  const ConfigurationChange change = compareConfigurations(
      parse("lcm: {pose_channel: POSE, pose_velocity: body}\ntables: t.bin\n"), parse(""));
  EXPECT_THAT(change.at_run_time, ElementsAre("lcm.pose_channel", "lcm.pose_velocity"));
  EXPECT_THAT(change.at_restart, ElementsAre("tables"));
}

}  // namespace
}  // namespace cartvo::daemon
