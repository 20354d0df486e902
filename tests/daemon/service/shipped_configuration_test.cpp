// The installed configuration file: it loads, explains each key and states the defaults of the code.

#include <fstream>
#include <map>
#include <regex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "daemon/service/configuration.hpp"
#include "support/places.hpp"

namespace cartvo::daemon {
namespace {

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

}  // namespace
}  // namespace cartvo::daemon
