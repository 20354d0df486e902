// Heights along two wheel tracks: each cell of the way has a level of its own, in part common to both tracks,
// with a short ramp from that of the cell before, and in some cells a bump.
#include "lab/render/motion/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lab/render/scenario_traits.hpp"
#include "lab/render/surface/hash.hpp"

namespace cartvo::world {
namespace {

constexpr double kCell = 1.3;        // m along the path
constexpr double kRamp = 0.16;       // m: a tyre rolls over a kerb as over a ramp
constexpr double kBump = 0.55;       // m along the path
constexpr double kBumpShare = 0.35;  // of the cells
constexpr double kCommon = 0.8;      // share of a level that both tracks have

}  // namespace

Obstacles::Obstacles(const WorldSettings& settings)
    : seed_(hashOf(
          {static_cast<std::uint32_t>(settings.seed), static_cast<std::uint32_t>(settings.scenario), 512U})),
      size_(settings.liveliness * traitsOf(settings.scenario).obstacles) {}

double Obstacles::random(std::int32_t cell, std::uint32_t track, std::uint32_t value) const {
  return 0x1.0p-32 * hashOf({seed_, static_cast<std::uint32_t>(cell), track, value});
}

double Obstacles::level(std::int32_t cell, bool left) const {
  return size_ * (kCommon * random(cell, 2, 0) + (1.0 - kCommon) * random(cell, left ? 1 : 0, 0));
}

double Obstacles::height(double distance, bool left) const {
  if (size_ == 0.0) return 0.0;
  const double whole = std::floor(distance / kCell);
  const auto cell = static_cast<std::int32_t>(whole);
  const double within = distance - whole * kCell;
  const std::uint32_t track = left ? 1 : 0;
  // The tracks meet the same kerb at different places: few kerbs lie square to the way.
  const double t = std::clamp((within - 0.25 * random(cell, track, 1)) / kRamp, 0.0, 1.0);
  const double before = level(cell - 1, left);
  const double ground = before + (level(cell, left) - before) * t * t * (3.0 - 2.0 * t);
  if (random(cell, 2, 2) >= kBumpShare) return ground;
  const double along = within - (kCell - kBump) * (0.6 + 0.4 * random(cell, track, 3));
  if (along <= 0.0 || along >= kBump) return ground;
  return ground + 0.5 * size_ * random(cell, track, 4) *
                      (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * along / kBump));
}

}  // namespace cartvo::world
