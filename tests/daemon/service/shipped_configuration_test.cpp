// The installed configuration file: it loads, explains each key and states the defaults of the code.
// Effects of a configuration that is read again: at run time, or at the next restart.
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <yaml-cpp/yaml.h>

#include "daemon/service/configuration.hpp"
#include "daemon/service/configuration_change.hpp"
#include "support/log_text.hpp"
#include "support/places.hpp"

namespace cartvo::daemon {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::filesystem::path kShipped = test::sourceFolder() / "config/cartvod.yaml";

constexpr const char* kMinimal = R"(cameras:
  left:
    url: rtsp://10.0.0.1/left
  right:
    url: rtsp://10.0.0.2/right
rig: rig.yaml
)";

/// Keys of the shipped file, active or commented out, with the comment above each.
std::map<std::string, std::string> documentedKeys() {
  static const std::regex kKey("^( *)(# )?([a-z_]+):( .*)?$");
  std::map<std::string, std::string> documented;
  std::ifstream stream(kShipped);
  std::vector<std::string> sections;
  std::string comment;
  for (std::string line; std::getline(stream, line);) {
    std::smatch parts;
    const bool is_key =
        std::regex_match(line, parts, kKey) && (!parts[2].matched || line.find(". ") == std::string::npos);
    if (!is_key) {
      const std::size_t text = line.find("# ");
      comment = line.empty() ? "" : comment + " " + (text == std::string::npos ? "" : line.substr(text + 2));
      continue;
    }
    sections.resize(static_cast<std::size_t>(parts[1].length()) / 2);
    std::string key;
    for (const std::string& section : sections)
      key += section + ".";
    documented[key + parts[3].str()] = comment;
    sections.push_back(parts[3]);
    comment.clear();
  }
  return documented;
}

TEST(ShippedConfiguration, Loads) {
  const Configuration configuration = readConfiguration(kShipped);
  EXPECT_EQ(configuration.left.password_credential, "left-camera-password");
}

TEST(ShippedConfiguration, OfTheDemoLoads) {
  const Configuration configuration = readConfiguration(test::sourceFolder() / "config/demo.yaml");
  EXPECT_EQ(configuration.left.url, "rtsp://127.0.0.1:8554/Streaming/Channels/101");
}

TEST(ShippedConfiguration, DocumentsExactlyTheReadKeys) {
  const std::map<std::string, std::string> documented = documentedKeys();
  const std::vector<std::string> known = configurationKeys();
  for (const std::string& key : known)
    EXPECT_TRUE(documented.contains(key)) << key << " is not in cartvod.yaml";
  for (const auto& [key, comment] : documented)
    EXPECT_THAT(known, testing::Contains(key));
}

TEST(ShippedConfiguration, StatesDefaultsOfTheCode) {
  static const std::regex kDefault("default (udpm:[^ ]+|[^ :]+)");
  const YAML::Node effective =
      YAML::Load(effectiveConfiguration(parseConfiguration(kMinimal, "/minimal/cartvod.yaml")));
  static const std::set<std::string> kSections = {
      "cameras", "cameras.left", "cameras.right", "odometry", "odometry.alert_limits",
      "lcm",     "recording",    "metrics",       "page",     "logging"};
  int checked = 0;
  for (const auto& [key, comment] : documentedKeys()) {
    const std::size_t dot = key.rfind('.');
    const std::string name = key.substr(dot == std::string::npos ? 0 : dot + 1);
    YAML::Node section;
    section.reset(effective);
    std::istringstream parts(key);
    std::string part;
    while (std::getline(parts, part, '.') && section.IsDefined() && part != name) {
      const YAML::Node next = section[part];
      section.reset(next);
    }
    const YAML::Node value = section.IsDefined() ? section[name] : YAML::Node(YAML::NodeType::Undefined);
    if (kSections.contains(key)) continue;
    if (comment.find("required") != std::string::npos || comment.find("As left") != std::string::npos)
      continue;
    std::smatch stated;
    const std::string tail = comment;
    ASSERT_TRUE(std::regex_search(tail, stated, std::regex("default (udpm:[^ ]+|[^ :]+)")))
        << key << ":" << comment;
    EXPECT_EQ(stated[1].str(), value.IsDefined() ? value.Scalar() : "none") << key;
    ++checked;
  }
  EXPECT_GT(checked, 10);
}

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
