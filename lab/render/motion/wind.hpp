#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "lab/render/scene/campus.hpp"
#include "lab/render/scene/path.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Bends trees and bushes and blows fallen leaves along the road, in the scenario `wind`. Their placements
/// are smooth functions of time alone.
class Wind {
 public:
  /// Appends the blown leaves to `campus`. `path` must outlive this object.
  Wind(const Path& path, const WorldSettings& settings, Campus& campus);

  /// Sets the placements of what the wind moves to those at `seconds`.
  void placeAt(double seconds, std::vector<Instance>& instances) const;

 private:
  struct Plant {
    std::uint32_t instance = 0;
    Eigen::Affine3f upright;  ///< placement without wind
    float sway = 0.0F;        ///< see Instance::sway
    double phase = 0.0;       ///< rad
  };
  struct Leaves {
    std::uint32_t instance = 0;
    double start = 0.0;    ///< m along the path at time 0
    double lateral = 0.0;  ///< m left of the path
    double speed = 0.0;    ///< m/s along the path
    double spin = 0.0;     ///< rad/s
  };

  void addLeaves(const WorldSettings& settings, Campus& campus);

  const Path& path_;
  Terrain terrain_;
  std::vector<Plant> plants_;
  std::vector<Leaves> leaves_;
};

}  // namespace cartvo::world
