// The data that makes each scenario.
#include "lab/render/scenario_traits.hpp"

#include <stdexcept>
#include <string>

namespace cartvo::world {
namespace {

constexpr LightLevels kOvercast{.sun = 0.15F, .sky = 0.6F, .ground = 0.15F};  // almost no shadows
constexpr LightLevels kDusk{.sun = 0.0F, .sky = 0.23F * 0.05F, .ground = 0.06F * 0.05F};
constexpr LightLevels kLamps{.sun = 0.0F, .sky = 0.08F, .ground = 0.04F};
constexpr double kRough = 0.032;  // m, amplitude of a rough road
constexpr double kRocks = 0.19;   // m, obstacles of a rough road
constexpr float kSmooth = 0.3F;   // contrast of smooth surfaces

std::vector<Eigen::Vector2d> campusLap() {
  return {{0, 0},    {70, 0},   {92, -27},  {138, -27}, {138, -95},
          {52, -95}, {34, -72}, {-20, -72}, {-45, -52}, {-45, 0}};
}

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

ScenarioTraits campus() {
  ScenarioTraits traits;
  traits.polygon = campusLap();
  return traits;
}

/// A path with one tight bend after the other.
ScenarioTraits lane() {
  ScenarioTraits traits;
  traits.polygon = windingLane();
  traits.corner_radius = 7.5;
  traits.corner_scatter = 1.0;
  return traits;
}

ScenarioTraits loop() {
  ScenarioTraits traits = campus();
  traits.polygon = shortLoop();
  return traits;
}

ScenarioTraits turns() {
  ScenarioTraits traits = lane();
  traits.road.left_kerb = 2.6;
  traits.vehicle_spacing = 0.0;
  return traits;
}

ScenarioTraits traffic() {
  ScenarioTraits traits = campus();
  traits.vehicle_spacing = 17.0;
  traits.bus_ahead = true;
  return traits;
}

ScenarioTraits standing() {
  ScenarioTraits traits = campus();
  traits.vehicle_spacing = 17.0;
  traits.overtaking = true;
  traits.vehicle_ahead = false;
  return traits;
}

ScenarioTraits underpass() {
  ScenarioTraits traits = campus();
  traits.underpasses = true;
  return traits;
}

ScenarioTraits glare() {
  ScenarioTraits traits = campus();
  traits.low_sun = LowSun{};
  return traits;
}

ScenarioTraits dusk() {
  ScenarioTraits traits = campus();
  traits.light = kDusk;
  return traits;
}

ScenarioTraits lowTexture() {
  ScenarioTraits traits = campus();
  traits.roughness = 0.003;
  traits.sparse = true;
  traits.vehicle_spacing = 140.0;
  traits.vehicle_ahead = false;
  traits.walkers = Walkers::none;
  traits.light = kOvercast;
  traits.texture_contrast = kSmooth;
  return traits;
}

ScenarioTraits bumpy() {
  ScenarioTraits traits = campus();
  traits.roughness = kRough;
  traits.obstacles = kRocks;
  return traits;
}

ScenarioTraits reversing() {
  ScenarioTraits traits = campus();
  traits.vehicle_ahead = false;
  return traits;
}

ScenarioTraits motorway() {
  ScenarioTraits traits = campus();
  traits.polygon = motorwayLoop();
  traits.corner_radius = 200.0;
  traits.road = {.right_kerb = -7.0, .left_kerb = 16.0};
  traits.roughness = 0.001;
  traits.sparse = traits.open = true;
  traits.vehicle_spacing = 0.0;
  traits.walkers = Walkers::none;
  traits.texture_contrast = kSmooth;
  return traits;
}

ScenarioTraits rough() {
  ScenarioTraits traits = campus();
  traits.roughness = 0.06;
  return traits;
}

ScenarioTraits garage() {
  ScenarioTraits traits = campus();
  traits.polygon = garageLoop();
  traits.corner_radius = 6.0;
  traits.corner_scatter = 0.3;
  traits.terrain.relief = 0.0;
  traits.roughness = 0.002;
  traits.garage = true;
  traits.vehicle_spacing = 0.0;
  traits.walkers = Walkers::none;
  traits.light = kLamps;
  traits.lamp_spacing = 5.0;
  return traits;
}

ScenarioTraits hedges() {
  ScenarioTraits traits = lane();
  traits.road = {.right_kerb = -1.5, .left_kerb = 1.5, .pavement_width = 0.0};
  traits.lining = Lining::hedge;
  traits.vehicle_spacing = 0.0;
  traits.walkers = Walkers::none;
  return traits;
}

ScenarioTraits rain() {
  ScenarioTraits traits = campus();
  traits.light = kOvercast;
  traits.drops_on_lens = true;
  return traits;
}

ScenarioTraits flicker() {
  ScenarioTraits traits = campus();
  traits.avenue = true;
  traits.houses = false;
  traits.low_sun = LowSun{.bearing = -0.44, .elevation = 0.25};
  return traits;
}

ScenarioTraits slope() {
  ScenarioTraits traits = campus();
  traits.terrain.relief = 4.0;
  return traits;
}

ScenarioTraits bridge() {
  ScenarioTraits traits = campus();
  traits.terrain.land_depth = 18.0;
  traits.road = {.right_kerb = -2.2, .left_kerb = 5.2, .pavement_width = 0.6, .verge_width = 0.0};
  traits.sparse = traits.open = true;
  traits.lining = Lining::railing;
  traits.walkers = Walkers::none;
  return traits;
}

ScenarioTraits crowd() {
  ScenarioTraits traits = campus();
  traits.vehicle_spacing = 0.0;
  traits.walkers = Walkers::crowd;
  return traits;
}

ScenarioTraits wind() {
  ScenarioTraits traits = campus();
  traits.avenue = traits.wind = true;
  return traits;
}

ScenarioTraits tunnel() {
  ScenarioTraits traits = campus();
  traits.corner_scatter = 0.0;
  traits.tunnel_exit = 16.0;
  return traits;
}

}  // namespace

ScenarioTraits traitsOf(Scenario scenario) {
  switch (scenario) {
    case Scenario::campus:
    case Scenario::stop_and_go:
    case Scenario::exposure:
      return campus();
    case Scenario::loop:
      return loop();
    case Scenario::turns:
      return turns();
    case Scenario::traffic:
      return traffic();
    case Scenario::standing:
      return standing();
    case Scenario::underpass:
      return underpass();
    case Scenario::glare:
      return glare();
    case Scenario::dusk:
      return dusk();
    case Scenario::low_texture:
      return lowTexture();
    case Scenario::bumpy:
    case Scenario::rough_road:
      return bumpy();
    case Scenario::reversing:
      return reversing();
    case Scenario::motorway:
      return motorway();
    case Scenario::rough:
      return rough();
    case Scenario::garage:
      return garage();
    case Scenario::hedges:
      return hedges();
    case Scenario::rain:
      return rain();
    case Scenario::flicker:
      return flicker();
    case Scenario::slope:
      return slope();
    case Scenario::bridge:
      return bridge();
    case Scenario::crowd:
      return crowd();
    case Scenario::wind:
      return wind();
    case Scenario::tunnel:
      return tunnel();
  }
  throw std::invalid_argument("unknown scenario number " + std::to_string(static_cast<int>(scenario)));
}

}  // namespace cartvo::world
