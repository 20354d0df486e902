// Names of scenarios and drives, and the start of the pictures.
#include "lab/render/world_settings.hpp"

#include <array>
#include <stdexcept>
#include <utility>

namespace cartvo::world {
namespace {

constexpr std::array<std::pair<Scenario, std::string_view>, 25> kNames{{
    {Scenario::campus, "campus"},
    {Scenario::loop, "loop"},
    {Scenario::turns, "turns"},
    {Scenario::traffic, "traffic"},
    {Scenario::standing, "standing"},
    {Scenario::stop_and_go, "stop_and_go"},
    {Scenario::exposure, "exposure"},
    {Scenario::underpass, "underpass"},
    {Scenario::glare, "glare"},
    {Scenario::dusk, "dusk"},
    {Scenario::low_texture, "low_texture"},
    {Scenario::bumpy, "bumpy"},
    {Scenario::reversing, "reversing"},
    {Scenario::motorway, "motorway"},
    {Scenario::rough, "rough"},
    {Scenario::rough_road, "rough_road"},
    {Scenario::garage, "garage"},
    {Scenario::hedges, "hedges"},
    {Scenario::rain, "rain"},
    {Scenario::flicker, "flicker"},
    {Scenario::slope, "slope"},
    {Scenario::bridge, "bridge"},
    {Scenario::crowd, "crowd"},
    {Scenario::wind, "wind"},
    {Scenario::tunnel, "tunnel"},
}};

}  // namespace

const std::vector<Scenario>& allScenarios() {
  static const std::vector<Scenario> scenarios = [] {
    std::vector<Scenario> all;
    all.reserve(kNames.size());
    for (const auto& [scenario, name] : kNames)
      all.push_back(scenario);
    return all;
  }();
  return scenarios;
}

std::string_view scenarioName(Scenario scenario) {
  for (const auto& [candidate, name] : kNames) {
    if (candidate == scenario) return name;
  }
  throw std::invalid_argument("unknown scenario number " + std::to_string(static_cast<int>(scenario)));
}

Scenario scenarioFromName(std::string_view name) {
  std::string known;
  for (const auto& [scenario, candidate] : kNames) {
    if (candidate == name) return scenario;
    known += (known.empty() ? "" : ", ") + std::string(candidate);
  }
  throw std::invalid_argument("unknown scenario '" + std::string(name) + "'; there are: " + known);
}

bool canBeLively(Scenario scenario) {
  return scenario != Scenario::motorway;
}

double startOf(const WorldSettings& settings) {
  constexpr double kUntilFullSpeed = 3.0;  // s
  if (settings.start_seconds) return *settings.start_seconds;
  return settings.liveliness > 0.0 ? settings.lead_in_seconds + kUntilFullSpeed : 0.0;
}

}  // namespace cartvo::world
