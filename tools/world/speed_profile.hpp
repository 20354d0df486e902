#pragma once

#include <vector>

#include "tools/world/path.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

constexpr double kSpeedStep = 0.02;  ///< s

/// The cart's speed each kSpeedStep, m/s: what the scenario wants, held to the bends, the motor and the
/// brakes, and smoothed. Zero during the lead-in.
std::vector<double> speedProfile(const Path& path, const WorldSettings& settings);

}  // namespace cartvo::world
