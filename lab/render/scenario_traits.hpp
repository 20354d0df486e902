#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "lab/render/scene/path.hpp"
#include "lab/render/scene/road.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Kind of the equal pieces that line both sides of a road without a gap.
enum class Lining : std::uint8_t { none, hedge, railing };

/// Light sources without shadows; unit of radiance: see Lighting.
struct LightLevels {
  float sun = 0.85F;     ///< direct light on a surface that faces the sun; 0: no shadows
  float sky = 0.23F;     ///< light of the sky on a level surface
  float ground = 0.06F;  ///< light reflected by the ground onto a downward surface
};

/// A low sun near the direction of the first stretch of road.
struct LowSun {
  double bearing = 0.0;     ///< rad, to the left of the road ahead
  double elevation = 0.15;  ///< rad
};

/// People on foot.
enum class Walkers : std::uint8_t { none, few, crowd };

/// Properties that distinguish the world of a scenario, as data. The defaults are those of the campus.
struct ScenarioTraits {
  /// Of the closed path, m.
  std::vector<Eigen::Vector2d> polygon{{0, 0},    {70, 0},   {92, -27},  {138, -27}, {138, -95},
                                       {52, -95}, {34, -72}, {-20, -72}, {-45, -52}, {-45, 0}};
  double corner_radius = 11.5;  ///< m
  double corner_scatter = 4.0;  ///< m, by which the seed moves each corner
  Terrain terrain{};
  RoadProfile road{};
  double roughness = 0.006;  ///< m, amplitude of the road's heights
  double obstacles = 0.055;  ///< m, height of the highest kerb that the wheels of a lively drive meet

  bool garage = false;  ///< indoors, in place of the campus
  bool sparse = false;  ///< few objects
  bool open = false;    ///< no objects near the path
  bool houses = true;
  Lining lining = Lining::none;         ///< of the road's borders
  bool avenue = false;                  ///< trees at equal distances on both sides
  bool underpasses = false;             ///< below broad bridges
  std::optional<double> tunnel_exit{};  ///< m along the path; the drive begins in the tunnel

  double vehicle_spacing = 55.0;  ///< m between vehicles; 0: none
  bool bus_ahead = false;         ///< close, in place of a car farther ahead
  bool overtaking = false;        ///< vehicles overtake the cart; else they are oncoming
  bool vehicle_ahead = true;      ///< in the cart's lane
  Walkers walkers = Walkers::few;
  bool wind = false;  ///< moves trees, bushes and fallen leaves

  LightLevels light{};
  std::optional<LowSun> low_sun{};
  double lamp_spacing = 0.0;      ///< m between the lamps of a ceiling; 0: none
  float texture_contrast = 1.0F;  ///< see TextureStyle
  bool drops_on_lens = false;
};

const ScenarioTraits& traitsOf(Scenario scenario);

}  // namespace cartvo::world
