// The name of each scenario and the data that makes it.
#include "lab/render/scenario_traits.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

namespace cartvo::world {
namespace {

constexpr LightLevels kOvercast{.sun = 0.15F, .sky = 0.6F, .ground = 0.15F};  // almost no shadows
constexpr LightLevels kDusk{.sun = 0.0F, .sky = 0.23F * 0.05F, .ground = 0.06F * 0.05F};
constexpr LightLevels kLamps{.sun = 0.0F, .sky = 0.08F, .ground = 0.04F};
constexpr double kRough = 0.032;                           // m, amplitude of a rough road
constexpr double kRocks = 0.19;                            // m, obstacles of a rough road
constexpr float kSmooth = 0.3F;                            // contrast of smooth surfaces
constexpr double kTightRadius = 7.5, kTightScatter = 1.0;  // m, of a path with one tight bend after the other
constexpr double kDenseTraffic = 17.0;                     // m between vehicles

std::vector<Eigen::Vector2d> windingLane() {
  return {{0, 0},     {18, 0},    {34, 17},   {56, -3},  {78, 15},  {97, -12},
          {80, -33},  {97, -55},  {70, -70},  {52, -50}, {34, -69}, {12, -50},
          {-10, -66}, {-30, -45}, {-18, -24}, {-38, -8}, {-20, 0}};
}

std::vector<Eigen::Vector2d> shortLoop() {
  return {{0, 0}, {45, 0}, {62, -21}, {62, -59}, {38, -80}, {-13, -80}, {-38, -57}, {-38, -19}};
}

std::vector<Eigen::Vector2d> motorwayLoop() {
  return {{0, 0}, {250, -40}, {420, -220}, {420, -480}, {250, -650}, {0, -690}, {-180, -520}, {-180, -170}};
}

/// The drive begins 26 m before a corner of the garage.
std::vector<Eigen::Vector2d> garageLoop() {
  return {{34, 0}, {60, 0}, {60, -30}, {0, -30}, {0, 0}};
}

ScenarioTraits lowTexture() {
  return {.roughness = 0.003,
          .sparse = true,
          .vehicle_spacing = 140.0,
          .vehicle_ahead = false,
          .walkers = Walkers::none,
          .light = kOvercast,
          .texture_contrast = kSmooth};
}

ScenarioTraits motorway() {
  return {.polygon = motorwayLoop(),
          .corner_radius = 200.0,
          .road = {.right_kerb = -7.0, .left_kerb = 16.0},
          .roughness = 0.001,
          .sparse = true,
          .open = true,
          .vehicle_spacing = 0.0,
          .walkers = Walkers::none,
          .texture_contrast = kSmooth};
}

ScenarioTraits garage() {
  return {.polygon = garageLoop(),
          .corner_radius = 6.0,
          .corner_scatter = 0.3,
          .terrain = {.relief = 0.0},
          .roughness = 0.002,
          .garage = true,
          .vehicle_spacing = 0.0,
          .walkers = Walkers::none,
          .light = kLamps,
          .lamp_spacing = 5.0};
}

ScenarioTraits hedges() {
  return {.polygon = windingLane(),
          .corner_radius = kTightRadius,
          .corner_scatter = kTightScatter,
          .road = {.right_kerb = -1.5, .left_kerb = 1.5, .pavement_width = 0.0},
          .lining = Lining::hedge,
          .vehicle_spacing = 0.0,
          .walkers = Walkers::none};
}

ScenarioTraits bridge() {
  return {.terrain = {.land_depth = 18.0},
          .road = {.right_kerb = -2.2, .left_kerb = 5.2, .pavement_width = 0.6, .verge_width = 0.0},
          .sparse = true,
          .open = true,
          .lining = Lining::railing,
          .walkers = Walkers::none};
}

using NamedTraits = std::pair<std::string_view, ScenarioTraits>;

/// In the order of the enumeration.
const auto& scenarios() {
  static const std::array<NamedTraits, 25> kScenarios{{
      {"campus", {}},
      {"loop", {.polygon = shortLoop()}},
      {"turns",
       {.polygon = windingLane(),
        .corner_radius = kTightRadius,
        .corner_scatter = kTightScatter,
        .road = {.left_kerb = 2.6},
        .vehicle_spacing = 0.0}},
      {"traffic", {.vehicle_spacing = kDenseTraffic, .bus_ahead = true}},
      {"standing", {.vehicle_spacing = kDenseTraffic, .overtaking = true, .vehicle_ahead = false}},
      {"stop_and_go", {}},
      {"exposure", {}},
      {"underpass", {.underpasses = true}},
      {"glare", {.low_sun = LowSun{}}},
      {"dusk", {.light = kDusk}},
      {"low_texture", lowTexture()},
      {"bumpy", {.roughness = kRough, .obstacles = kRocks}},
      {"reversing", {.vehicle_ahead = false}},
      {"motorway", motorway()},
      {"rough", {.roughness = 0.06}},
      {"rough_road", {.roughness = kRough, .obstacles = kRocks}},
      {"garage", garage()},
      {"hedges", hedges()},
      {"rain", {.light = kOvercast, .drops_on_lens = true}},
      {"flicker", {.houses = false, .avenue = true, .low_sun = LowSun{.bearing = -0.44, .elevation = 0.25}}},
      {"slope", {.terrain = {.relief = 4.0}}},
      {"bridge", bridge()},
      {"crowd", {.vehicle_spacing = 0.0, .walkers = Walkers::crowd}},
      {"wind", {.avenue = true, .wind = true}},
      {"tunnel", {.corner_scatter = 0.0, .tunnel_exit = 16.0}},
  }};
  return kScenarios;
}

const NamedTraits& find(Scenario scenario) {
  const auto number = static_cast<std::size_t>(scenario);
  if (number < scenarios().size()) return scenarios()[number];
  throw std::invalid_argument("unknown scenario number " + std::to_string(number));
}

}  // namespace

std::vector<Scenario> allScenarios() {
  std::vector<Scenario> all;
  for (std::size_t number = 0; number < scenarios().size(); ++number)
    all.push_back(static_cast<Scenario>(number));
  return all;
}

std::string_view scenarioName(Scenario scenario) {
  return find(scenario).first;
}

Scenario scenarioFromName(std::string_view name) {
  std::string known;
  for (const Scenario scenario : allScenarios()) {
    if (scenarioName(scenario) == name) return scenario;
    known += (known.empty() ? "" : ", ") + std::string(scenarioName(scenario));
  }
  throw std::invalid_argument("unknown scenario '" + std::string(name) + "'; there are: " + known);
}

const ScenarioTraits& traitsOf(Scenario scenario) {
  return find(scenario).second;
}

}  // namespace cartvo::world
