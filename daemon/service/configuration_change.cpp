// Compares two configurations key by key.

#include "daemon/service/configuration_change.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <yaml-cpp/yaml.h>

#include "daemon/diagnostics/journal.hpp"

namespace cartvo::daemon {
namespace {

/// The keys that Daemon::reload applies.
const std::set<std::string>& runTimeKeys() {
  static const std::set<std::string> kKeys{"lcm.time_to_live", "lcm.pose_channel", "lcm.pose_velocity",
                                           "logging.level"};
  return kKeys;
}

void addValues(const YAML::Node& node, const std::string& key, std::map<std::string, std::string>& values) {
  if (!node.IsMap()) {
    values[key] = node.Scalar();
    return;
  }
  for (const auto& entry : node) {
    const auto name = entry.first.as<std::string>();
    addValues(entry.second, key.empty() ? name : key + "." + name, values);
  }
}

std::map<std::string, std::string> valuesOf(const Configuration& configuration) {
  std::map<std::string, std::string> values;
  addValues(YAML::Load(effectiveConfiguration(configuration)), "", values);
  return values;
}

void logReload(spdlog::level::level_enum level, const std::string& result) {
  logEvent(level, "configuration read again: " + result, {{"CARTVO_EVENT", "configuration"}});
}

}  // namespace

void ConfigurationChange::logAndSetLevel(spdlog::level::level_enum next) const {
  spdlog::set_level(std::min(spdlog::get_level(), next));
  if (at_run_time.empty() && at_restart.empty()) logReload(spdlog::level::info, "no value has changed");
  if (!at_run_time.empty())
    logReload(spdlog::level::info, fmt::format("changed: {}", fmt::join(at_run_time, ", ")));
  if (!at_restart.empty())
    logReload(spdlog::level::warn,
              fmt::format("changes with the next restart: {}", fmt::join(at_restart, ", ")));
  spdlog::set_level(next);
}

ConfigurationChange compareConfigurations(const Configuration& running, const Configuration& next) {
  const std::map<std::string, std::string> before = valuesOf(running), after = valuesOf(next);
  std::set<std::string> keys;
  for (const auto* values : {&before, &after}) {
    for (const auto& [key, value] : *values)
      keys.insert(key);
  }
  ConfigurationChange change;
  for (const std::string& key : keys) {
    const auto old = before.find(key), now = after.find(key);
    if (old != before.end() && now != after.end() && old->second == now->second) continue;
    (runTimeKeys().contains(key) ? change.at_run_time : change.at_restart).push_back(key);
  }
  return change;
}

}  // namespace cartvo::daemon
