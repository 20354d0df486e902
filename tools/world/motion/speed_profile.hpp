#pragma once

#include <vector>

#include "tools/world/scene/path.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

constexpr double kSpeedStep = 0.02;  ///< s, step of the profile

/// The cart's speed at each kSpeedStep, m/s, negative backward: the scenario's speed limited by bends, motor
/// and brakes, and smoothed. Zero during the lead-in.
std::vector<double> speedProfile(const Path& path, const WorldSettings& settings);

}  // namespace cartvo::world
