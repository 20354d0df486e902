#pragma once

#include <cstdint>

#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Kerbs, joints and bumps that the wheels of a lively drive meet, as heights along the two wheel tracks.
/// None in a calm drive.
class Obstacles {
 public:
  explicit Obstacles(const WorldSettings& settings);

  /// Height below a wheel, m, `distance` m along the path.
  double height(double distance, bool left) const;

 private:
  double level(std::int32_t cell, bool left) const;
  double random(std::int32_t cell, std::uint32_t track, std::uint32_t value) const;

  std::uint32_t seed_ = 0;
  double size_ = 0.0;  ///< m, height of the highest kerb
};

}  // namespace cartvo::world
