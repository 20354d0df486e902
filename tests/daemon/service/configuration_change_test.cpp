// Effects of a configuration that is read again: at run time, or at the next restart.

#include "daemon/service/configuration_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "support/log_text.hpp"

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
  const test::LogText log;
  change.logAndSetLevel(spdlog::level::info);
  EXPECT_EQ(log.linesWith("configuration read again: no value has changed"), 1);
}

TEST(ConfigurationChange, SeparatesWhatChangesNowFromWhatNeedsARestart) {
  const ConfigurationChange change = compareConfigurations(
      parse("odometry: {features: 500}\n"),
      parse("odometry: {features: 600}\nlcm: {time_to_live: 0.3}\nlogging: {level: debug}\n"
            "metrics: {listen: 9464}\n"));
  EXPECT_THAT(change.at_run_time, ElementsAre("lcm.time_to_live", "logging.level"));
  EXPECT_THAT(change.at_restart, ElementsAre("metrics.listen", "odometry.features"));
  const test::LogText log;
  change.logAndSetLevel(spdlog::level::debug);
  EXPECT_EQ(log.linesWith("[info] configuration read again: changed: lcm.time_to_live, logging.level"), 1);
  EXPECT_EQ(
      log.linesWith("[warning] configuration read again: changes with the next restart: metrics.listen, "
                    "odometry.features"),
      1);
}

TEST(ConfigurationChange, IsLoggedAtTheMoreVerboseOfTheOldAndTheNewLevel) {
  using spdlog::level::level_enum, spdlog::level::info, spdlog::level::warn;
  const auto lines = [](level_enum before, level_enum next) {
    const test::LogText log;
    spdlog::set_level(before);
    ConfigurationChange{{"logging.level"}, {"rig"}}.logAndSetLevel(next);
    EXPECT_EQ(spdlog::get_level(), next);
    return log.linesWith("configuration read again: ");
  };
  EXPECT_EQ(lines(warn, info), 2);
  EXPECT_EQ(lines(info, warn), 2);
  EXPECT_EQ(lines(warn, warn), 1) << "what needs a restart";
}

TEST(ConfigurationChange, FindsKeysThatWereRemoved) {
  const ConfigurationChange change = compareConfigurations(
      parse("lcm: {pose_channel: POSE, pose_velocity: body}\ntables: t.bin\n"), parse(""));
  EXPECT_THAT(change.at_run_time, ElementsAre("lcm.pose_channel", "lcm.pose_velocity"));
  EXPECT_THAT(change.at_restart, ElementsAre("tables"));
}

}  // namespace
}  // namespace cartvo::daemon
